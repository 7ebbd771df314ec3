#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>

namespace palpate::studies {

/// `discrepancies`: random worlds that palpated's model does not describe (discrepancies.yaml),
/// each simulated once and replayed by an estimator; whether, when and how it reports them.
class DiscrepanciesCommand {
 public:
  explicit DiscrepanciesCommand(CLI::App& app);
  ~DiscrepanciesCommand();

  /// Runs the worlds that have no result yet, prints one row per kind and returns the exit code: 0,
  /// or 1 if a run failed; empty if the command was not given. `root`: the source tree. Throws
  /// config::Error for an invalid plan, std::invalid_argument for an unknown set, and Interrupted.
  std::optional<int> run(const std::filesystem::path& root, std::ostream& out);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace palpate::studies
