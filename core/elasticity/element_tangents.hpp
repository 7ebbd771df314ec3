#pragma once

#include <memory>

#include "core/elasticity/element_set.hpp"
#include "core/factor/block_matrix.hpp"

namespace palpate::elasticity {

/// Stiffness of all elements of a body, four elements at once, assembled directly into block
/// matrices: with the linear law the sum of the matrices of ElementSet::stiffness. Keeps the
/// rotations of the last shape as starting points; not thread-safe.
class ElementTangents {
 public:
  virtual ~ElementTangents() = default;

  /// `tangent` = tangent of this kind at positions x (3 x n); `warped`, unless null, = that of
  /// Tangent::kWarped. Both must have the pattern passed to make_element_tangents.
  virtual void assemble(const Eigen::Matrix3Xd& x, Tangent kind, factor::BlockMatrix& tangent,
                        factor::BlockMatrix* warped) noexcept = 0;
};

/// `pattern` must be that of the elements' mesh and outlive the result.
std::unique_ptr<ElementTangents> make_element_tangents(const ElementSet& elements,
                                                       const factor::BlockPattern& pattern);

/// Consistent mass of a body, kg: one number per block of the pattern, a multiple of the identity.
Eigen::VectorXd mass_blocks(const ElementSet& elements, const factor::BlockPattern& pattern);

}  // namespace palpate::elasticity
