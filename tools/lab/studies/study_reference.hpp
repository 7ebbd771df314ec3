#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace palpate::studies {

/// Prints every key of plans as a table in Markdown, from the declarations in the code.
class StudyReferenceCommand {
 public:
  explicit StudyReferenceCommand(CLI::App& app);

  /// Prints the table if the command was given and returns the exit code: 0, or 1 if a key has no
  /// description. `root`: the source tree. Throws config::Error for an invalid plan.
  std::optional<int> run(const std::filesystem::path& root, std::ostream& out) const;

 private:
  std::vector<std::string> plans_;
  CLI::App* command_;
};

}  // namespace palpate::studies
