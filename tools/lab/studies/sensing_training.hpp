#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>

namespace palpate::studies {

/// The command `train-sensing`: trains the networks of the baselines that learn a shape
/// (tools/lab/baselines/learning/learned_shape.hpp) on recordings of motions that no study uses.
class TrainSensingCommand {
 public:
  explicit TrainSensingCommand(CLI::App& app);
  ~TrainSensingCommand();

  /// Runs the command if it was given and returns the exit code. `root`: the source tree. Throws
  /// config::Error for an invalid file, RunFailed and Interrupted.
  std::optional<int> run(const std::filesystem::path& root, std::ostream& out);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace palpate::studies
