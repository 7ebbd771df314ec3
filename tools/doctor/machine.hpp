#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::doctor {

/// A machine as its files tell of it: this one, or a tree that looks like one.
class Machine {
 public:
  explicit Machine(std::filesystem::path root = "/") : root_(std::move(root)) {}

  /// The whole file without white space at its end; nothing where it cannot be read. `path` from
  /// the root, without a leading slash.
  std::optional<std::string> read(const std::string& path) const;
  std::vector<std::string> lines(const std::string& path) const;  // empty where it cannot be read
  std::optional<std::int64_t> number(const std::string& path) const;
  /// Names in a folder, sorted; empty where it cannot be read.
  std::vector<std::string> list(const std::string& path) const;
  bool exists(const std::string& path) const;
  /// What a symbolic link says; empty where it is none.
  std::string link(const std::string& path) const;
  /// Follows links, those with absolute targets within the root; the path from the root, or nothing
  /// where it leads nowhere.
  std::optional<std::string> resolve(const std::string& path) const;

 private:
  std::filesystem::path root_;
};

/// The words between white space.
std::vector<std::string> words_of(const std::string& line);

/// "0-2,5" as {0, 1, 2, 5}; stops at what is no such list.
std::vector<int> cpu_list(const std::string& text);

}  // namespace palpate::doctor
