#pragma once

#include "core/elasticity/deformation_model.hpp"
#include "core/estimation/wrench_filter.hpp"

namespace palpate::estimation {

/// Derivatives of held patches and of the hands' wrenches with respect to the filter states, for
/// compliant grasps. The model's sensitivities assume that a patch moves exactly as prescribed;
/// with a compliance C between hand and patch it moves less by C w. With K = dw/dxi and B = dw/dp
/// of rigidly held patches: dw = (I + K C)^-1 (K dxi + B dp), and the patch moves by dxi - C dw. C
/// contains the pads and the compliance of grasp_compliance(). Nothing allocates.
class PatchMotion {
 public:
  using Wrenches = Eigen::Matrix<double, 12, 12>;

  /// `shape_size`: number of states that influence the shape (WrenchFilter::shape_size()). All
  /// derivatives are zero before the first update().
  explicit PatchMotion(int shape_size);

  /// `X_OG`: poses of the held grasps; `stiffness`: Young's modulus divided by that of the model.
  /// The model's sensitivity must be valid.
  void update(const elasticity::DeformationModel& model, const WrenchFilter& filter,
              const std::array<math::Pose, 2>& X_OG, double stiffness) noexcept;

  /// Derivative of the model's inputs with respect to the shape states: rows of grasps are motions
  /// of their patches (m, rad, in O), the others log E, motions of obstacles (m, rad) and
  /// virtual loads (N).
  const WrenchFilter::ShapeMatrix& by_state() const noexcept { return by_state_; }
  /// (I + K C)^-1, six rows per grasp: maps wrenches of rigidly held patches to those of the hands.
  const Wrenches& felt() const noexcept { return felt_; }
  /// Derivative of the hands' wrenches divided by `stiffness` with respect to the same states, in
  /// O, six rows per grasp.
  using WrenchRows = Eigen::Matrix<double, 12, Eigen::Dynamic, 0, 12, WrenchFilter::kMostShape>;
  const WrenchRows& wrench_by_state() const noexcept { return wrench_by_state_; }

 private:
  WrenchFilter::ShapeMatrix by_state_;
  WrenchRows wrench_by_state_;
  Wrenches felt_ = Wrenches::Identity();
};

}  // namespace palpate::estimation
