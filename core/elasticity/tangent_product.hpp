#pragma once

#include "core/elasticity/element_forces.hpp"

namespace palpate::elasticity {

/// Product of the exact static tangent at the present shape and a sensitivity column, as a central
/// difference of element forces without assembling a matrix. Relative error about 1e-4, from the
/// nonlinearity of the forces over the difference.
class TangentProduct {
 public:
  TangentProduct(const Body& body, const std::vector<Lame>& materials,
                 const std::vector<int>& numbering, Precision precision);

  /// Product (N per unit of the column's motion) at positions `x` (m), in their node numbering.
  const NodalField& multiply(const NodalField& x, const NodalField& column) noexcept;

 private:
  std::unique_ptr<ElementForces> forces_;
  double move_;  // m, displacement of the node that moves most
  NodalField x_, forward_, backward_;
};

}  // namespace palpate::elasticity
