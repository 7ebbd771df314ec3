#include "core/kinematics/serial_chain.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

namespace palpate::kinematics {

SerialChain::SerialChain(std::vector<Joint> joints, const math::Pose& X_JE)
    : joints_(std::move(joints)), X_JE_(X_JE) {
  if (joints_.empty() || joints_.size() > kMostJoints)
    throw std::invalid_argument("an arm has 1 to " + std::to_string(kMostJoints) +
                                " joints that move, not " + std::to_string(joints_.size()));
  for (const Joint& joint : joints_) {
    const auto refuse = [&](const char* what) {
      throw std::invalid_argument("joint " + joint.name + ": " + what);
    };
    if (!(std::abs(joint.axis_J.norm() - 1) < 1e-6)) refuse("its axis is not of unit length");
    if (!(joint.lower < joint.upper) || !std::isfinite(joint.upper - joint.lower))
      refuse("its lower limit is not below the upper one");
    if (!(joint.speed > 0 && std::isfinite(joint.speed))) refuse("its speed limit is not positive");
    if (!joint.X_PJ.matrix().allFinite()) refuse("its origin is not finite");
  }
}

void SerialChain::evaluate(const Eigen::Ref<const Eigen::VectorXd>& q,
                           State& state) const noexcept {
  const int n = joint_count();
  std::array<Eigen::Vector3d, kMostJoints> axis, origin;
  math::Pose X = math::Pose::Identity();
  for (int i = 0; i < n; ++i) {
    const Joint& joint = joints_[i];
    X = X * joint.X_PJ;
    axis[i] = X.linear() * joint.axis_J;
    origin[i] = X.translation();
    if (joint.revolute) {
      X.linear() = X.linear() * math::exp_rotation(q[i] * joint.axis_J);
    } else {
      X.translation() += q[i] * axis[i];
    }
  }
  state.X_WE = X * X_JE_;
  state.J_W_E.resize(6, n);
  for (int i = 0; i < n; ++i) {
    if (joints_[i].revolute) {
      state.J_W_E.col(i) << axis[i].cross(state.X_WE.translation() - origin[i]), axis[i];
    } else {
      state.J_W_E.col(i) << axis[i], Eigen::Vector3d::Zero();
    }
  }
}

}  // namespace palpate::kinematics
