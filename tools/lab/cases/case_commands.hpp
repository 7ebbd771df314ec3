#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>

namespace palpate::cases {

/// The commands for the deformation model alone: static, dynamic and beam.
class CaseCommands {
 public:
  explicit CaseCommands(CLI::App& app);
  ~CaseCommands();

  /// Runs the given command and returns its exit code; empty for any other command. `data`: folder
  /// of recordings. Throws config::Error for an invalid case.
  std::optional<int> run(const std::filesystem::path& data, std::ostream& out);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* static_command_;
  CLI::App* dynamic_command_;
  CLI::App* beam_command_;
};

}  // namespace palpate::cases
