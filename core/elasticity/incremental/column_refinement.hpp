#pragma once

#include <memory>

#include "core/elasticity/incremental/tracked_sensitivity.hpp"
#include "core/elasticity/incremental/warped_factor.hpp"

namespace palpate::elasticity {

/// Product of the exact static tangent at the present shape and a sensitivity column, as a central
/// difference of element forces without assembling a matrix. Relative error about 1e-4, from the
/// nonlinearity of the forces over the difference.
class TangentProduct {
 public:
  TangentProduct(const NumberedBody& body, Precision precision);

  /// Product (N per unit of the column's motion) at positions `x` (m).
  const NodalField& multiply(const NodalField& x, const NodalField& column) noexcept;

 private:
  std::unique_ptr<ElementForces> forces_;
  double move_;  // m, displacement of the node that moves most
  NodalField x_, forward_, backward_;
};

/// Refinement of sensitivity columns between factorisations: the response to one motion of one held
/// grasp is corrected with the factor used by the step. Rotation alone does not account for loads
/// whose direction changes relative to the object.
class ColumnRefinement {
 public:
  /// All must outlive this object.
  ColumnRefinement(const NumberedBody& body, const BoundaryConditions& boundary,
                   WarpedFactor& factor, TrackedSensitivity& sensitivity, Precision precision);

  /// Corrects the next column at positions `x`: x' <- x' - H K x', because the forces on free nodes
  /// must not change.
  void refine_next(const NodalField& x) noexcept;

 private:
  void load_column(const NodalField& x, int g, int k) noexcept;

  const NumberedBody& body_;
  const BoundaryConditions& boundary_;
  WarpedFactor& factor_;
  TrackedSensitivity& sensitivity_;
  TangentProduct tangent_;
  NodalField column_;           // column under refinement
  Eigen::VectorXf correction_;  // three per unknown node
  int refined_ = 0;             // 6 grasp + motion, the column refined last
};

}  // namespace palpate::elasticity
