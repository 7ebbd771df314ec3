#pragma once

#include "core/elasticity/element_forces.hpp"

namespace palpate::elasticity {

/// Product of the exact static tangent of now and a column of a sensitivity, as a central
/// difference of element forces, so that no matrix is assembled. Exact to some 1e-4, since forces
/// bend that much over the difference.
class TangentProduct {
 public:
  TangentProduct(const Body& body, const std::vector<Lame>& materials,
                 const std::vector<int>& numbering, Precision precision);

  /// Product (N per unit of the column's motion) at positions `x` (m), nodes numbered as there.
  const NodalField& multiply(const NodalField& x, const NodalField& column) noexcept;

 private:
  std::unique_ptr<ElementForces> forces_;
  double move_;  // m, that the node which moves most is moved by
  NodalField x_, forward_, backward_;
};

}  // namespace palpate::elasticity
