#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>

namespace palpate::evaluate {

/// The command `tune-sensing`: the same number of random trials for every published sensing method,
/// on a motion that no study runs.
class TuneSensingCommand {
 public:
  explicit TuneSensingCommand(CLI::App& app);
  ~TuneSensingCommand();

  /// Runs it where it was given and returns the exit code. `root`: the source tree. Throws
  /// config::Error for a bad file, RunFailed and Interrupted.
  std::optional<int> run(const std::filesystem::path& root, std::ostream& out);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace palpate::evaluate
