#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "tools/types/parser.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace palpate::types {

/// Message types that are known by their .lcm descriptions alone, found by their fingerprints.
class TypeSet {
 public:
  TypeSet() = default;
  /// All .lcm files of folders, with their subfolders, and single files. Throws std::runtime_error
  /// naming file and line: a file that cannot be read or parsed, a type that is described twice,
  /// a member whose type none of them describes; or a folder without descriptions.
  explicit TypeSet(const std::vector<std::filesystem::path>& paths);
  /// One file by its text.
  TypeSet(const std::string& text, const std::string& file);

  /// By name. Types with the same fingerprint (those with the same members) are not distinguished;
  /// messages count as the first of them.
  const std::vector<std::shared_ptr<Struct>>& structs() const { return structs_; }
  bool empty() const { return structs_.empty(); }
  /// nullptr if there is none.
  const Struct* find(const std::string& name) const;
  /// The type of an encoded message; nullptr for an unknown one and for less than a fingerprint.
  const Struct* type_of(const void* data, int size) const;

 private:
  void add(Description description);
  void resolve();

  std::vector<std::shared_ptr<Struct>> structs_;
  std::vector<Enumeration> enumerations_;
  std::unordered_map<std::int64_t, const Struct*> by_fingerprint_;
};

/// The types of lcmtypes/, from their descriptions, which the program contains.
const TypeSet& own_types();

/// --types FOLDER, repeatable, for TypeSet's constructor.
void add_types_option(CLI::App& app, std::vector<std::filesystem::path>& paths);

}  // namespace palpate::types
