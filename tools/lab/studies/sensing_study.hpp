#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>

namespace palpate::studies {

/// The command `published-sensing`: a plan of kinds `force` and `tactile`, in which the hand's
/// motion does not depend on the estimate, so that each application is simulated once for each
/// level and seed, and every method then runs on the same recording (palpate-replay).
class SensingStudyCommand {
 public:
  explicit SensingStudyCommand(CLI::App& app);
  ~SensingStudyCommand();

  /// Runs the command if it was given and returns the exit code: 0, or 1 if a run failed. `root`:
  /// the source tree. Throws config::Error for an invalid plan, and Interrupted.
  std::optional<int> run(const std::filesystem::path& root, std::ostream& out);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace palpate::studies
