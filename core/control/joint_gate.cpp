#include "core/control/joint_gate.hpp"

#include <Eigen/Cholesky>

#include "core/control/control_law.hpp"
#include "core/math/option_check.hpp"

namespace palpate::control {
namespace {

/// Smallest joint velocities for this hand twist, damped near singular configurations.
kinematics::SerialChain::Joints joints_for(const kinematics::SerialChain::Jacobian& J,
                                           const math::Vector6d& V) noexcept {
  constexpr double kDamping = 1e-3;  // m or rad per rad
  math::Matrix6d squared = J.lazyProduct(J.transpose());
  squared.diagonal().array() += kDamping * kDamping;
  const math::Vector6d pull = squared.llt().solve(V);
  return J.transpose().lazyProduct(pull);
}

}  // namespace

JointGate::JointGate(const JointLimits& limits) : limits_(limits) {
  limits.check();
  math::check_option(!limits.empty(), "limits", limits.count(), "those of at least one joint");
  last_ = Joints::Zero(limits.count());
}

const char* JointGate::reason_to_reject(const JointGateInputs& joints) const noexcept {
  if (joints.q.size() != last_.size() || joints.J_W_E.cols() != last_.size())
    return "the joints are not known";
  if (joints.requested.size() != last_.size() || !joints.requested.allFinite())
    return "requested joint velocity is not finite";
  if (!joints.q.allFinite() || !joints.J_W_E.allFinite()) return "joint positions are not finite";
  return nullptr;
}

JointGate::Joints JointGate::braked(double dt) const noexcept {
  const Joints bound = (limits_.speed / kGateStopTime).cwiseMax(limits_.acceleration) * dt;
  return last_ - last_.cwiseMax(-bound).cwiseMin(bound);
}

/// Limits the change from the last command towards `wanted`.
JointGate::Joints JointGate::limited(const JointGateInputs& joints, const Joints& wanted, double dt,
                                     const char*& reason) const noexcept {
  const Joints change = wanted - last_;
  double part = 1, share = 1;
  for (int i = 0; i < change.size(); ++i)
    if (std::abs(change[i]) > limits_.acceleration[i] * dt)
      part = std::min(part, limits_.acceleration[i] * dt / std::abs(change[i]));
  if (part < 1) reason = "joint acceleration";
  const Joints next = last_ + part * change;
  for (int i = 0; i < next.size(); ++i) {
    const double gap =
        next[i] > 0 ? limits_.upper[i] - joints.q[i] : joints.q[i] - limits_.lower[i];
    const double most =
        std::min(limits_.speed[i], approach_speed(gap, 0.5 * limits_.acceleration[i], dt));
    if (std::abs(next[i]) <= most) continue;
    share = std::min(share, most / std::abs(next[i]));
    reason = most < limits_.speed[i] ? "joint position" : "joint speed";
  }
  return share * next;
}

GateOutput JointGate::apply(const JointGateInputs& joints, GateInputs inputs,
                            SafetyGate& hand) noexcept {
  const double dt = gate_step(inputs.dt);
  const char* rejection = reason_to_reject(joints);
  if (rejection == nullptr) {
    if (!in_use_) last_ = joints_for(joints.J_W_E, hand.last().vector());
    inputs.requested_W_E =
        math::Twist::from(math::Vector6d(joints.J_W_E.lazyProduct(joints.requested)));
  } else {
    inputs.active = false;  // the twist gate ramps down as well
  }
  in_use_ = true;
  GateOutput output = hand.apply(inputs);
  if (rejection != nullptr) {
    output.rejected = true;
    output.reason = rejection;
  }
  if (!inputs.active || output.rejected) {
    last_ = braked(dt);
  } else {
    Joints wanted = joints.requested;
    if (output.limited)
      wanted += joints_for(joints.J_W_E, output.V_W_E.vector() - inputs.requested_W_E.vector());
    last_ = limited(joints, wanted, dt, output.reason);
    const math::Twist V = math::Twist::from(math::Vector6d(joints.J_W_E.lazyProduct(last_)));
    last_ *= hand.share_within(V, inputs.X_WE, dt);
  }
  if (!last_.allFinite()) {
    pass();
    output.rejected = true;
    output.reason = "command is not finite";
  }
  output.joint_velocity = last_;
  if (rejection == nullptr)
    output.V_W_E = math::Twist::from(math::Vector6d(joints.J_W_E.lazyProduct(last_)));
  output.limited = rejection != nullptr || last_ != joints.requested;
  hand.replace_last(output.V_W_E);
  return output;
}

}  // namespace palpate::control
