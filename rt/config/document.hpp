#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace palpate::config {

/// YAML document with data shared by its readers: origin, overrides, and the keys that have been
/// read. `path` is the full key of a node: "" for the root, "a.0.b" below a list.
class Document {
 public:
  /// Throws Error if `text` is not one YAML mapping with unique plain keys, or exceeds the limits
  /// of size and depth (aliases count as their content).
  Document(const std::string& text, const std::string& name, const std::string& folder);

  /// Loads a file. With `base: FILE` (relative to the file's folder) its entries override those of
  /// that file, which may have a base itself: mappings are merged key by key, other values are
  /// replaced, and an empty entry removes that of the base. Throws Error, also if a file cannot be
  /// read or is its own base.
  static std::shared_ptr<Document> load(const std::string& path);

  /// Applies "path.to.key=value"; "path.to.key=~" removes the key.
  void apply_override(const std::string& text);

  const YAML::Node& root() const { return root_; }
  const std::string& name() const { return top_.name; }
  /// Folder of the file that defines the value at `path`.
  const std::string& folder(const std::string& path) const { return source(path).folder; }

  /// See Node::changed().
  std::shared_ptr<Document> changed(const std::string& path, const std::string& text, bool replace,
                                    const std::string& name) const;

  /// "file:line", or the override that set the value at `path`; `line` is 0-based, -1 if unknown.
  std::string location(const std::string& path, int line) const;

  void mark_used(const std::string& path, const std::string& key) { used_[path].insert(key); }
  /// Keys of the mapping at `path` that have been read, present or not.
  const std::set<std::string>& used(const std::string& path) const;

  /// Adds a warning about the document, unless it is known.
  void warn(const std::string& text);
  const std::vector<std::string>& warnings() const { return warnings_; }

  /// 64-bit FNV-1a hash of the document as emitted in YAML.
  std::int64_t hash() const;

 private:
  struct Source {
    std::string name;
    std::string folder;
  };
  struct Override {
    std::string path;
    std::string text;
  };

  Document() = default;
  static std::shared_ptr<Document> load_chain(const std::string& path,
                                              std::vector<std::string>& chain);
  std::string take_base(std::string& where);
  void put_over(const Document& base);
  void claim(const YAML::Node& node, const std::string& path);
  const Source& source(const std::string& path) const;
  void add_override(const std::string& path, const std::string& text);
  void check_keys(const YAML::Node& node, const std::string& path) const;

  YAML::Node root_;
  Source top_;                             // the file that was loaded
  std::map<std::string, Source> sources_;  // source of each key outside lists
  std::vector<Override> overrides_;
  std::map<std::string, std::set<std::string>> used_;
  std::vector<std::string> warnings_;
};

/// "a.b" from "a" and "b"; "b" below the root.
std::string join(const std::string& path, const std::string& key);

}  // namespace palpate::config
