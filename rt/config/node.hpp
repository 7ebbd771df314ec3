#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/math/rigid.hpp"
#include "rt/config/key.hpp"

namespace palpate::config {

/// Exit code of a program whose configuration is wrong (sysexits' EX_CONFIG).
inline constexpr int kExitCode = 78;

/// A wrong configuration: what() reads "file:line: key: what is wrong; allowed: ...".
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Closed range of an allowed number.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// Strict view of one YAML node. Every getter throws Error with file, line, full key and allowed
/// range; getters with a default return it where the key is absent. A key that nobody asked for is
/// an error when check_all_used() is called on the root. A Key with unit and meaning declares the
/// parameter for the reference.
class Node {
 public:
  /// Reads a file and what it builds on (`base: FILE`: its entries go over those of that file; see
  /// Document::load), then applies overrides "path.to.key=value" (value is YAML; list items by
  /// index: "sensing.0.component=ft_tare_only"). The overridden key need not exist.
  static Node load_file(const std::string& path, const std::vector<std::string>& overrides = {});
  static Node from_text(const std::string& text, const std::string& name = "<text>");

  bool has(const std::string& key) const;
  bool is_mapping(const std::string& key) const;  // false where absent
  Node child(const Key& key) const;               // mapping; throws where absent
  Node child_or_empty(const Key& key) const;      // an empty mapping where absent
  std::vector<Node> list(const Key& key) const;   // sequence of mappings; empty where absent
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
  /// A sequence of texts, none of them empty.
  std::vector<std::string> texts(const Key& key) const;
  /// A sequence of `count` numbers (any count where -1).
  std::vector<double> numbers(const Key& key, int count, Range range = {}) const;
  Eigen::Vector3d vector3(const Key& key, Range range = {}) const;
  Eigen::Vector3d vector3(const Key& key, Range range, const Eigen::Vector3d& otherwise) const;
  std::vector<Eigen::Vector3d> points(const Key& key) const;  // sequence of [x, y, z]
  /// {position: [x, y, z], quaternion: [w, x, y, z]} or {position: ..., rpy_deg: [r, p, y]};
  /// identity where absent.
  math::Pose pose(const Key& key) const;
  /// A path, taken relative to the folder of the file that gives it.
  std::string path(const Key& key) const;

  /// Declares a number that comes with a unit ("10 mm"), which its reader takes apart himself;
  /// `otherwise` tells what its absence means, where it need not be there and that is known.
  void declare_quantity(const Key& key, Range range, bool is_required,
                        const std::string& otherwise = "") const;

  /// Throws Error naming the first key below this node that no getter has asked for, with the keys
  /// that are known beside it.
  void check_all_used() const;

  /// Counts everything in the mapping `key` as asked for, where it is there: another reader of the
  /// same text checks it.
  void leave_to_another(const std::string& key) const;

  /// Throws Error at `key` of this node (or at the node itself where it is empty).
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

  /// A copy of the whole document, which this is the root of, where the mapping `text` (YAML) has
  /// been put over that at `path` ("sensing.0"; "": the root), or has taken its place. Nothing in
  /// it counts as asked for. Throws Error, which calls the text `name`.
  Node changed(const std::string& path, const std::string& text, bool replace,
               const std::string& name) const;

  /// The entry as YAML, to compare it with another's; empty where it is absent.
  std::string dump(const std::string& key) const;
  /// The node itself.
  std::string dump() const;

  /// 64-bit hash of the whole document after overrides.
  std::int64_t hash() const;

 private:
  struct Impl;
  explicit Node(std::shared_ptr<Impl> impl);
  std::shared_ptr<Impl> impl_;
};

}  // namespace palpate::config
