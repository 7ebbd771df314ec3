#pragma once

#include <optional>

#include "rt/config/node.hpp"

namespace palpate::config {

/// A material as palpate-fit writes it: section `material` with its model and what was told of its
/// constants, and, where Young's modulus was, section `corotational` with the linear one that comes
/// closest to it. What the file tells goes over an object's own section `material`.
class MaterialFile {
 public:
  /// Reads the file that the key `material_file` of `object` names; nothing where there is no such
  /// key. Throws Error where it cannot be read or is no such file.
  static std::optional<MaterialFile> read(const Node& object);

  std::string model() const;
  Node constants() const { return root_.child("material"); }
  /// Throws Error at `material_file` where it has none.
  Node corotational() const;

  /// The constant, or `otherwise` where the file does not tell it. Throws Error outside the range.
  double constant(const Key& key, Range range, double otherwise) const;

 private:
  MaterialFile(const Node& holder, const Node& root) : holder_(holder), root_(root) {}

  Node holder_, root_;
};

/// Section `material` of an object, which may be absent beside a file.
Node material_section(const Node& object);

/// Number `key` of the file's section `fitted`, where there is one that has it, else of `material`.
/// Throws Error where neither has it, or it is out of range in either.
double material_number(const Node& material, const std::optional<Node>& fitted, const Key& key,
                       Range range);

}  // namespace palpate::config
