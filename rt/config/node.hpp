#pragma once

#include <Eigen/Core>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "rt/config/declarations.hpp"
#include "rt/config/key.hpp"
#include "rt/config/option.hpp"

namespace palpate::config {

/// Exit code of a program with an invalid configuration (EX_CONFIG of sysexits).
inline constexpr int kExitCode = 78;

/// Configuration error: what() is "file:line: key: error; allowed: ...".
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Strict view of one YAML node. Every getter throws Error with file, line, full key and allowed
/// range; getters with a default return it if the key is absent. Keys that were not read by any
/// getter are an error when check_all_used() is called on the root. A Key with unit and meaning
/// declares the parameter for the reference.
class Node {
 public:
  /// Loads a file and its bases (`base: FILE`: see Document::load), then applies overrides
  /// "path.to.key=value" (value is YAML; list items by index: "sensing.0.component=ft_tare_only").
  /// The overridden key need not exist.
  static Node load_file(const std::string& path, const std::vector<std::string>& overrides = {});
  static Node from_text(const std::string& text, const std::string& name = "<text>");

  bool has(const std::string& key) const;
  bool is_mapping(const std::string& key) const;  // false if absent
  Node child(const Key& key) const;               // mapping; throws if absent
  Node child_or_empty(const Key& key) const;      // an empty mapping if absent
  std::vector<Node> list(const Key& key) const;   // sequence of mappings; empty if absent
  std::vector<std::string> keys() const;

  double number(const Key& key, Range range) const;
  double number(const Key& key, Range range, double otherwise) const;
  int integer(const Key& key, Range range) const;
  int integer(const Key& key, Range range, int otherwise) const;
  bool flag(const Key& key, bool otherwise) const;
  std::string text(const Key& key) const;
  std::string text(const Key& key, const std::string& otherwise) const;
  /// One of `allowed`.
  std::string choice(const Key& key, const std::vector<std::string>& allowed) const;
  std::string choice(const Key& key, const std::vector<std::string>& allowed,
                     const std::string& otherwise) const;
  /// The name of a component, one of `known`.
  std::string component(const Key& key, const Choices& known) const;
  /// A sequence of non-empty texts.
  std::vector<std::string> texts(const Key& key) const;
  /// A sequence of `count` numbers (any count if -1).
  std::vector<double> numbers(const Key& key, int count, Range range = {}) const;
  std::vector<double> numbers(const Key& key, int count, Range range,
                              const std::vector<double>& otherwise) const;
  Eigen::Vector3d vector3(const Key& key, Range range = {}) const;
  Eigen::Vector3d vector3(const Key& key, Range range, const Eigen::Vector3d& otherwise) const;
  std::vector<Eigen::Vector3d> points(const Key& key) const;  // sequence of [x, y, z]
  /// {position: [x, y, z], quaternion: [w, x, y, z]} or {position: ..., rpy_deg: [r, p, y]};
  /// identity if absent.
  math::Pose pose(const Key& key) const;
  /// A path, relative to the folder of the file that defines it.
  std::string path(const Key& key) const;

  /// The value of a declared option, or its default if the key is absent. The key may have a former
  /// name (Option::aliases), of which warnings() warns; both at once are an error.
  OptionValue value(const Option& option) const;
  /// The options of a component: read by the declarations of `table`.
  template <class Options>
  Options read(const OptionTable<Options>& table) const {
    Options options = table.defaults();
    for (const auto& entry : table.entries())
      if (has_value(entry.option)) entry.assign(options, value(entry.option));
    return options;
  }

  /// A line for each key of the document that has been read by its former name, with file, line,
  /// former and present name.
  const std::vector<std::string>& warnings() const;

  /// Declares a number with a unit ("10 mm") that its reader parses; `otherwise` describes the
  /// meaning of an absent key that is not required.
  void declare_quantity(const Key& key, Range range, bool is_required,
                        const std::string& otherwise = "") const;

  /// Throws Error naming the first key below this node that no getter has read, with the known keys
  /// of the same mapping.
  void check_all_used() const;

  /// Marks everything in the mapping `key`, if present, as read, because another reader of the same
  /// text checks it.
  void leave_to_another(const std::string& key) const;

  /// Throws Error at `key` of this node (or at the node itself if it is empty).
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

  /// A copy of the whole document, of which this is the root, with the mapping `text` (YAML) merged
  /// over that at `path` ("sensing.0"; "": the root), or replacing it. Nothing in it is marked as
  /// read. Throws Error, in which the text is called `name`.
  Node changed(const std::string& path, const std::string& text, bool replace,
               const std::string& name) const;

  /// The entry as YAML, for comparison; empty if absent.
  std::string dump(const std::string& key) const;
  /// The node itself.
  std::string dump() const;

  /// 64-bit hash of the whole document after overrides.
  std::int64_t hash() const;

 private:
  struct Impl;
  explicit Node(std::shared_ptr<Impl> impl);
  /// False, and declared, for an optional key that is absent.
  bool has_value(const Option& option) const;
  /// Name by which the document contains the option: its own, or a former one.
  std::string given_name(const Option& option) const;
  std::shared_ptr<Impl> impl_;
};

}  // namespace palpate::config
