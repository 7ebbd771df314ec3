#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace palpate::config {

/// A YAML document with what its readers share: where it came from, what was overridden, and which
/// keys have been asked for. `path` is the full key of a node, "" the root, "a.0.b" below a list.
class Document {
 public:
  /// Throws Error where `text` is not one YAML mapping with unique plain keys, or is larger or
  /// deeper than any configuration (aliases count as what they stand for).
  Document(const std::string& text, const std::string& name, const std::string& folder);

  /// Reads a file. Where it says `base: FILE` (relative to its own folder), its entries are put
  /// over those of that file, which may have a base itself: mappings are merged key by key,
  /// anything else is replaced whole, and an empty entry takes away that of the base. Throws Error,
  /// also where a file cannot be read or is its own base.
  static std::shared_ptr<Document> load(const std::string& path);

  /// Applies "path.to.key=value"; "path.to.key=~" takes the key away.
  void apply_override(const std::string& text);

  const YAML::Node& root() const { return root_; }
  const std::string& name() const { return top_.name; }
  /// Folder of the file that gives the value at `path`.
  const std::string& folder(const std::string& path) const { return source(path).folder; }

  /// See Node::changed().
  std::shared_ptr<Document> changed(const std::string& path, const std::string& text, bool replace,
                                    const std::string& name) const;

  /// "file:line", or the override that set the value at `path`; `line` is 0-based, -1 where
  /// unknown.
  std::string location(const std::string& path, int line) const;

  void mark_used(const std::string& path, const std::string& key) { used_[path].insert(key); }
  /// Keys of the mapping at `path` that were asked for, there or not.
  const std::set<std::string>& used(const std::string& path) const;

  /// 64-bit FNV-1a of the document as a YAML emitter writes it.
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
  Source top_;                             // the file that was asked for
  std::map<std::string, Source> sources_;  // of each key outside lists
  std::vector<Override> overrides_;
  std::map<std::string, std::set<std::string>> used_;
};

/// "a.b" from "a" and "b"; "b" below the root.
std::string join(const std::string& path, const std::string& key);

}  // namespace palpate::config
