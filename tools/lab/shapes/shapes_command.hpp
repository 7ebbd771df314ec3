#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>

namespace palpate::shapes {

/// The command `shapes`: real objects whose shape was measured.
class ShapesCommand {
 public:
  explicit ShapesCommand(CLI::App& app);
  ~ShapesCommand();

  /// Runs the command if it was given and returns its exit code. `data`: folder of recordings
  /// unless the command names one. Throws config::Error or recordings::CsvError for a wrong
  /// recording.
  std::optional<int> run(const std::filesystem::path& data, std::ostream& out);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
  CLI::App* command_;
};

}  // namespace palpate::shapes
