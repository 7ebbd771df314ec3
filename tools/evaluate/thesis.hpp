#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>

namespace palpate::evaluate {

/// The command thesis: the applications of the thesis, run, scored and reported.
class ThesisCommand {
 public:
  explicit ThesisCommand(CLI::App& app);
  ~ThesisCommand();

  /// Runs it where it was given and returns the exit code: 0, or 1 where a job failed. `root`: the
  /// source tree. Throws config::Error for a bad plan, and Interrupted.
  std::optional<int> run(const std::filesystem::path& root, std::ostream& out);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace palpate::evaluate
