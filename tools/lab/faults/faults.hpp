#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>

namespace palpate::faults {

/// The command faults: faults injected in virtual time, seed by seed, each compared with its
/// required outcome.
class FaultsCommand {
 public:
  explicit FaultsCommand(CLI::App& app);
  ~FaultsCommand();

  /// Runs the command if it was given and returns the exit code: 0, or 1 if a run failed or a bound
  /// was missed. Throws config::Error and std::runtime_error.
  std::optional<int> run(std::ostream& out);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace palpate::faults
