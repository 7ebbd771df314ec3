#pragma once

#include <memory>

#include "core/elasticity/element_set.hpp"
#include "core/factor/block_matrix.hpp"

namespace palpate::elasticity {

/// Stiffness of all elements of a body at once, four elements side by side, straight into block
/// matrices: the sum of what ElementSet::stiffness gives one by one. Remembers the rotations of the
/// last shape, from which the next search for them starts; one thread uses it at a time.
class ElementTangents {
 public:
  virtual ~ElementTangents() = default;

  /// `tangent` = tangent of this kind at positions x (3 x n); `warped`, unless null, = the one of
  /// Tangent::kWarped. Both must have the pattern given to make_element_tangents.
  virtual void assemble(const Eigen::Matrix3Xd& x, Tangent kind, factor::BlockMatrix& tangent,
                        factor::BlockMatrix* warped) noexcept = 0;
};

/// `pattern` must be of the elements' mesh and outlive the result.
std::unique_ptr<ElementTangents> make_element_tangents(const ElementSet& elements,
                                                       const factor::BlockPattern& pattern);

/// Consistent mass of a body, kg: one number for each block of the pattern, which is that many
/// times the unit matrix.
Eigen::VectorXd mass_blocks(const ElementSet& elements, const factor::BlockPattern& pattern);

}  // namespace palpate::elasticity
