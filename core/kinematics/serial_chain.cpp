#include "core/kinematics/serial_chain.hpp"

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

void SerialChain::locate(const Eigen::Ref<const Eigen::VectorXd>& q, Frames& X_WJ) const noexcept {
  math::Pose X = math::Pose::Identity();
  for (int i = 0; i < joint_count(); ++i) {
    const Joint& joint = joints_[i];
    X = X * joint.X_PJ;
    if (joint.revolute) {
      X.linear() = X.linear() * math::exp_rotation(q[i] * joint.axis_J);
    } else {
      X.translation() += q[i] * X.linear() * joint.axis_J;
    }
    X_WJ[i] = X;
  }
}

void SerialChain::evaluate(const Eigen::Ref<const Eigen::VectorXd>& q,
                           State& state) const noexcept {
  const int n = joint_count();
  Frames X_WJ;
  locate(q, X_WJ);
  state.X_WE = X_WJ[n - 1] * X_JE_;
  state.J_W_E.resize(6, n);
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d axis = X_WJ[i].linear() * joints_[i].axis_J;
    if (joints_[i].revolute) {
      state.J_W_E.col(i) << axis.cross(state.X_WE.translation() - X_WJ[i].translation()), axis;
    } else {
      state.J_W_E.col(i) << axis, Eigen::Vector3d::Zero();
    }
  }
}

}  // namespace palpate::kinematics
