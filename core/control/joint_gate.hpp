#pragma once

#include "core/control/control_law.hpp"
#include "core/control/safety_gate.hpp"

namespace palpate::control {

struct JointGateInputs {
  kinematics::SerialChain::Joints requested;  // rad/s
  kinematics::SerialChain::Joints q;
  kinematics::SerialChain::Jacobian J_W_E;
};

/// Last step before publication of joint commands. The hand's twist J dq/dt passes the twist gate,
/// and the joint velocities are adapted to the result. Limits of acceleration, speed and position
/// then apply to each joint; a joint approaches a position limit only as fast as it can stop with
/// half its maximum acceleration.
///
/// - Changes made by the twist gate are realised by the smallest change of the joint velocities.
/// - Speed and position limits scale all joints by one factor, so that the direction of the hand's
///   motion is kept.
/// - A rejected or inactive command ramps every joint to zero within 100 ms.
/// - The output respects the hand's speed and workspace limits after the joints' limits have been
///   applied.
class JointGate {
 public:
  /// Throws std::invalid_argument if the limits are inconsistent.
  explicit JointGate(const JointLimits& limits);

  /// `hand`: twist gate of the same arm; requested_W_E of its inputs is ignored. The output always
  /// contains finite joint velocities, one per joint of the limits.
  GateOutput apply(const JointGateInputs& joints, GateInputs inputs, SafetyGate& hand) noexcept;

  /// Call if the hand is commanded by a twist in this tick, or no joint moves: the joints' commands
  /// restart from zero.
  void pass() noexcept {
    last_.setZero();
    in_use_ = false;
  }

 private:
  using Joints = kinematics::SerialChain::Joints;
  const char* reason_to_reject(const JointGateInputs& joints) const noexcept;
  Joints braked(double dt) const noexcept;
  Joints limited(const JointGateInputs& joints, const Joints& wanted, double dt,
                 const char*& reason) const noexcept;

  JointLimits limits_;
  Joints last_;
  bool in_use_ = false;
};

}  // namespace palpate::control
