#include "core/kinematics/serial_chain.hpp"

#include <array>
#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::kinematics {

SerialChain::SerialChain(std::vector<Joint> joints, const math::Pose& X_JE)
    : joints_(std::move(joints)), X_JE_(X_JE) {
  math::check_option(!joints_.empty() && joints_.size() <= kMostJoints, "joints", joints_.size(),
                     "1 to " + std::to_string(kMostJoints) + " joints that move");
  for (const Joint& joint : joints_) {
    const std::string name = "joint " + joint.name + ": ";
    math::check_option(std::abs(joint.axis_J.norm() - 1) < 1e-6, name + "axis",
                       joint.axis_J.transpose(), "a vector of unit length");
    math::check_option(joint.lower < joint.upper && std::isfinite(joint.upper - joint.lower),
                       name + "lower limit", joint.lower,
                       "below the upper limit, " + std::to_string(joint.upper) + ", both finite");
    math::check_option(joint.speed > 0 && std::isfinite(joint.speed), name + "speed limit",
                       joint.speed, "above 0 and finite");
    math::check_option(joint.X_PJ.matrix().allFinite(), name + "origin",
                       joint.X_PJ.translation().transpose(), "a finite pose");
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
