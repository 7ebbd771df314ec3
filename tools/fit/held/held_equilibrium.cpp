#include "tools/fit/held/held_equilibrium.hpp"

#include <Eigen/LU>
#include <cmath>

namespace palpate::fit {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kTolerance = 1e-8;  // m and rad, of the yield, which is refined below it
constexpr int kSteps = 12;           // of Newton's method

/// Both halves of a twist or wrench turned by R.
math::Matrix6d turning(const Matrix3d& R) {
  math::Matrix6d both = math::Matrix6d::Zero();
  both.topLeftCorner<3, 3>() = R;
  both.bottomRightCorner<3, 3>() = R;
  return both;
}

}  // namespace

bool HeldEquilibrium::solve(const math::Pose& X_OH, const Matrix3Xd& near,
                            const math::Vector6d& yield, const elasticity::StaticOptions& options) {
  const Matrix3Xd no_loads = Matrix3Xd::Zero(3, body_.mesh.node_count());
  const math::Matrix6d to_hand = turning(X_OH.linear().transpose());
  const bool is_rigid = pads_.isZero(0);
  X_OH_ = X_OH;
  yield_ = is_rigid ? math::Vector6d::Zero() : yield;
  double last = HUGE_VAL;
  for (int i = 0; i < kSteps; ++i) {
    X_OG_ = X_OH * math::make_pose(math::exp_rotation(yield_.tail<3>()), yield_.head<3>());
    auto found = solver_.solve(no_loads, {X_OG_, {}}, options, i == 0 ? &near : &positions_);
    if (!found.converged) return false;
    positions_ = std::move(found.positions);
    wrench_ = elasticity::patch_wrench(body_.grasps[0], X_OH, positions_, found.reactions);
    if (is_rigid) return true;
    const math::Vector6d gap = yield_ + pads_ * to_hand * wrench_.vector();
    const double size = gap.cwiseAbs().maxCoeff();
    if (size == 0 || (size < kTolerance && size > 0.1 * last)) return true;  // down to rounding
    last = size;
    response_ = solver_.response();
    if (!response_.valid) return false;
    const math::Matrix6d slope = math::Matrix6d::Identity() + pads_ * to_hand * wrench_by_yield();
    yield_ -= slope.partialPivLu().solve(gap);
  }
  return false;
}

/// (dp_O, rotation in O) of the patch.
math::Matrix6d HeldEquilibrium::patch_by_yield() const {
  math::Matrix6d by_yield = turning(X_OH_.linear());
  by_yield.bottomRightCorner<3, 3>() *= math::inverse_left_jacobian(yield_.tail<3>()).inverse();
  return by_yield;
}

/// Changes of the wrench at the origin of the patch's G, which moves, to those at the hand's.
HeldEquilibrium::Columns HeldEquilibrium::at_hand(const Columns& patch, const Columns& hand,
                                                  const Columns& wrench) const {
  const Vector3d arm = X_OG_.translation() - X_OH_.translation();
  Columns moved = wrench;
  moved.bottomRows<3>() +=
      math::cross_matrix(arm) * wrench.topRows<3>() -
      math::cross_matrix(wrench_.force) * (patch.topRows<3>() - hand.topRows<3>());
  return moved;
}

math::Matrix6d HeldEquilibrium::wrench_by_yield() const {
  const math::Matrix6d patch = patch_by_yield();
  return at_hand(patch, math::Matrix6d::Zero(), response_.dw_dxi[0][0] * patch);
}

bool HeldEquilibrium::differentiate(const Changes& changes) {
  response_ = solver_.response();
  if (!response_.valid) return false;
  material_ = changes.material;
  // At constant yield the patch follows the hand.
  const Vector3d arm = X_OG_.translation() - X_OH_.translation();
  patch_ = changes.hand;
  patch_.topRows<3>() -= math::cross_matrix(arm) * changes.hand.bottomRows<3>();
  wrench_columns_ =
      at_hand(patch_, changes.hand,
              response_.dw_dparameter[0] * material_ + response_.dw_dxi[0][0] * patch_);
  if (pads_.isZero(0)) return true;

  const math::Matrix6d to_hand = turning(X_OH_.linear().transpose());
  Columns seen = wrench_columns_;  // in the hand's axes, which turn
  seen.topRows<3>() += math::cross_matrix(wrench_.force) * changes.hand.bottomRows<3>();
  seen.bottomRows<3>() += math::cross_matrix(wrench_.torque) * changes.hand.bottomRows<3>();
  Columns gap = pads_ * to_hand * seen;
  for (const auto& [parameter, by_parameter] : changes.pads)
    gap.col(parameter) += by_parameter * to_hand * wrench_.vector();
  const math::Matrix6d by_yield = wrench_by_yield();
  const Columns yields =
      -(math::Matrix6d::Identity() + pads_ * to_hand * by_yield).partialPivLu().solve(gap);
  patch_ += patch_by_yield() * yields;
  wrench_columns_ += by_yield * yields;
  return true;
}

Matrix3Xd HeldEquilibrium::node_columns(int node) const {
  return response_.dx_dparameter.middleRows<3>(3 * node) * material_ +
         response_.dx_dxi[0].middleRows<3>(3 * node) * patch_;
}

}  // namespace palpate::fit
