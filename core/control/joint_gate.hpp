#pragma once

#include "core/control/joint_limits.hpp"
#include "core/control/safety_gate.hpp"

namespace palpate::control {

struct JointGateInputs {
  kinematics::SerialChain::Joints requested;  // rad/s
  kinematics::SerialChain::Joints q;
  kinematics::SerialChain::Jacobian J_W_E;
};

/// The last step before the wire where joints are commanded: the hand's twist J dq/dt passes the
/// gate of twists, and the joints move as it lets the hand; then, joint by joint, limits of
/// acceleration, of speed and of position, towards whose end a joint goes only as fast as it can
/// still brake by half its acceleration.
///
/// - What the gate of twists changes is made up for by the smallest change of the joints.
/// - Speed and position are kept by one factor for all joints, so that the hand's way stays.
/// - A refused or inactive command ramps every joint to zero within 100 ms.
/// - What leaves keeps the speed and the workspace of the hand, whatever the joints' limits have
///   made of it.
class JointGate {
 public:
  /// Throws std::invalid_argument where limits make no sense.
  explicit JointGate(const JointLimits& limits);

  /// `hand`: the gate of the same arm; requested_W_E of its inputs is not looked at. The output
  /// always has finite joint velocities, as many as limits speak of.
  GateOutput apply(const JointGateInputs& joints, GateInputs inputs, SafetyGate& hand) noexcept;

  /// The hand is commanded by a twist in this tick, or no joint moves: the joints begin anew.
  void pass() noexcept {
    last_.setZero();
    in_use_ = false;
  }

 private:
  using Joints = kinematics::SerialChain::Joints;
  const char* refusal(const JointGateInputs& joints) const noexcept;
  Joints braked(double dt) const noexcept;
  Joints limited(const JointGateInputs& joints, const Joints& wanted, double dt,
                 const char*& reason) const noexcept;

  JointLimits limits_;
  Joints last_;
  bool in_use_ = false;
};

}  // namespace palpate::control
