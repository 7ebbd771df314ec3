#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::doctor {

/// A machine as described by its files: this one, or a test tree in its form.
class Machine {
 public:
  explicit Machine(std::filesystem::path root = "/") : root_(std::move(root)) {}

  /// The whole file without trailing white space; empty if it cannot be read. `path` from the root,
  /// without a leading slash.
  std::optional<std::string> read(const std::string& path) const;
  std::vector<std::string> lines(const std::string& path) const;  // empty if it cannot be read
  std::optional<std::int64_t> number(const std::string& path) const;
  /// Names in a folder, sorted; empty if it cannot be read.
  std::vector<std::string> list(const std::string& path) const;
  bool exists(const std::string& path) const;
  /// Target of a symbolic link; empty if it is not one.
  std::string link(const std::string& path) const;
  /// Follows links, those with absolute targets within the root; the path from the root, or empty
  /// if it does not exist.
  std::optional<std::string> resolve(const std::string& path) const;

 private:
  std::filesystem::path root_;
};

/// The words separated by white space.
std::vector<std::string> words_of(const std::string& line);

/// "0-2,5" as {0, 1, 2, 5}; stops at anything else.
std::vector<int> cpu_list(const std::string& text);

}  // namespace palpate::doctor
