#include "core/elasticity/corotational_model.hpp"

// Refinement of sensitivity columns between factorisations: the response to one motion of one held
// grasp is corrected with the factor used by the step. Rotation alone does not account for loads
// whose direction changes relative to the object.
namespace palpate::elasticity {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Corrects the next column: x' <- x' - H K x', because the forces on free nodes must not change.
void CorotationalModel::refine_column() noexcept {
  if (!tangent_ || !at_snapshot_.valid || !factor_.exact) return;
  refined_ = (refined_ + 1) % 12;
  if (!held_[refined_ / 6]) refined_ = (refined_ + 6) % 12;
  const int g = refined_ / 6, k = refined_ % 6;
  if (!held_[g]) return;
  const int axis = k % 3, first = k - axis;

  const Matrix3d R = grasps_[g].applied.linear() * grasps_[g].snapshot.linear().transpose();
  column_.setZero();
  for (int node = 0; node < positions_.cols(); ++node) {
    const int i = numbering_[node];
    if (i >= warp_.size()) continue;
    const Vector3d then =
        at_snapshot_.dx_dxi[g].block<3, 3>(3 * node, first) * R.row(axis).transpose();
    column_.col(i).head<3>() = warp_.matrix(i).cast<double>() * then;
  }
  for (int other = 0; other < static_cast<int>(body_.grasps.size()); ++other) {
    if (!held_[other]) continue;
    for (int node : body_.grasps[other].nodes) {
      auto moved = column_.col(numbering_[node]).head<3>();
      moved.setZero();
      if (other != g) continue;
      const Vector3d r = x_.col(numbering_[node]).head<3>() - grasps_[g].applied.translation();
      moved = k < 3 ? Vector3d::Unit(axis) : Vector3d(Vector3d::Unit(axis).cross(r));
    }
  }

  const NodalField& felt = tangent_->multiply(x_, column_);
  for (int i = 0; i < pattern_.size(); ++i) {
    correction_.segment<3>(3 * i) = -felt.col(i).head<3>().cast<float>();
  }
  solve_for(correction_);
  if (!correction_.allFinite()) return;
  for (int i = 0; i < pattern_.size(); ++i) {
    column_.col(i).head<3>() += correction_.segment<3>(3 * i).cast<double>();
  }
  set_column(g, k);
}

/// Stores column_ as column k of grasp g, both as published and, rotated back, at the snapshot.
void CorotationalModel::set_column(int g, int k) noexcept {
  const int axis = k % 3, first = k - axis;
  const Matrix3d R = grasps_[g].applied.linear() * grasps_[g].snapshot.linear().transpose();
  for (int node = 0; node < positions_.cols(); ++node) {
    const int i = numbering_[node];
    const Vector3d now = column_.col(i).head<3>();
    sensitivity_.dx_dxi[g].block<3, 1>(3 * node, k) = now;
    if (i >= warp_.size()) continue;
    const Matrix3d W = warp_.matrix(i).cast<double>();
    auto then = at_snapshot_.dx_dxi[g].block<3, 3>(3 * node, first);
    const Vector3d change = W.transpose() * now - then * R.row(axis).transpose();
    then += change * R.row(axis);
  }
}

}  // namespace palpate::elasticity
