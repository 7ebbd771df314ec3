#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>

namespace palpate::uncertainty {

/// File of the distributions called `name` ("calibrated") in the source tree `root`; it may not
/// exist.
std::filesystem::path distributions_file(const std::filesystem::path& root,
                                         const std::string& name);

/// `draws`: the draws of a file of distributions, to check before a study runs them.
class DrawsCommand {
 public:
  explicit DrawsCommand(CLI::App& app);

  /// Prints the table if the command was given and returns the exit code. `root`: the source tree.
  /// Throws config::Error for an invalid file and std::out_of_range for a draw that does not exist.
  std::optional<int> run(const std::filesystem::path& root, std::ostream& out) const;

 private:
  std::string distributions_ = "calibrated";
  int draws_ = 100;
  std::uint64_t seed_ = 1;
  int draw_ = 0;  // that is printed with its overrides; 0: the table of all
  std::filesystem::path scene_, configuration_, csv_, json_;
  CLI::App* command_;
};

}  // namespace palpate::uncertainty
