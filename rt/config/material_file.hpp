#pragma once

#include <optional>

#include "rt/config/node.hpp"

namespace palpate::config {

/// Material file written by palpate-fit: section `material` with its model and the identified
/// constants and, if Young's modulus was identified, section `corotational` with the closest linear
/// material. Values in the file override the object's own section `material`.
class MaterialFile {
 public:
  /// Reads the file named by the key `material_file` of `object`; empty without that key. Throws
  /// Error if it cannot be read or is not a material file.
  static std::optional<MaterialFile> read(const Node& object);

  std::string model() const;
  Node constants() const { return root_.child("material"); }
  /// Throws Error at `material_file` if the section is absent.
  Node corotational() const;

  /// Largest magnitude of the strains of the recordings; empty if the file does not state it.
  std::optional<double> largest_strain() const;

  /// The constant, or `otherwise` if the file does not contain it. Throws Error outside the range.
  double constant(const Key& key, Range range, double otherwise) const;

 private:
  MaterialFile(const Node& holder, const Node& root) : holder_(holder), root_(root) {}

  Node holder_, root_;
};

/// Section `material` of an object, which may be absent if there is a material file.
Node material_section(const Node& object);

/// Number `key` of the file's section `fitted`, if present there, otherwise of `material`. Throws
/// Error if both lack it, or if it is out of range in either.
double material_number(const Node& material, const std::optional<Node>& fitted, const Key& key,
                       Range range);

}  // namespace palpate::config
