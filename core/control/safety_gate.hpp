#pragma once

#include <algorithm>
#include <cmath>

#include "core/kinematics/serial_chain.hpp"

namespace palpate::control {

inline constexpr double kGateStopTime = 0.1;  // s, from full speed to rest

/// The time step that a gate counts with: 1 ms in place of one that makes no sense, 0.1 s at most.
inline double gate_step(double dt) noexcept {
  return std::isfinite(dt) && dt > 0 ? std::min(dt, 0.1) : 1e-3;
}

/// Limits of what may leave the daemon, all of the flange E in W.
struct GateLimits {
  double linear_speed = 0.10;                  // m/s
  double angular_speed = 0.5;                  // rad/s
  double linear_acceleration = 0.5;            // m/s^2
  double angular_acceleration = 2.0;           // rad/s^2
  double force = 10.0;                         // N, contact force above which the hand is stopped
  double torque = 3.0;                         // N m
  Eigen::Vector3d workspace_lower{-1, -1, 0};  // m, of the origin of E in W
  Eigen::Vector3d workspace_upper{1, 1, 1.5};
};

struct GateInputs {
  double dt = 1e-3;
  bool active = false;  // false: the command ramps to zero
  math::Twist requested_W_E;
  math::Pose X_WE = math::Pose::Identity();
  bool wrench_valid = false;
  math::Wrench contact;  // tared wrench at the wrist
};

struct GateOutput {
  math::Twist V_W_E;                               // always finite and within limits
  kinematics::SerialChain::Joints joint_velocity;  // that makes it, where joints are commanded
  bool limited = false;                            // differs from what was requested
  bool refused = false;  // the request was not finite, or force or torque is too high
  const char* reason = "";
};

/// The last step before the wire: limits, then a check that every number is finite.
///
/// - Speed is scaled, the whole twist by one factor.
/// - The change since the last command keeps the acceleration limits.
/// - The workspace is a velocity damper on each axis: towards a wall only as fast as the
/// acceleration
///   limit can still stop, outside only back.
/// - A refused or inactive command ramps to zero within 100 ms, if need be by more than the
///   acceleration limit. A force or torque that was too high is refused until it is below 90 % of
///   its limit.
/// - A time step that is not positive and finite is refused and counts as 1 ms, one above 0.1 s as
///   0.1 s.
class SafetyGate {
 public:
  /// Throws std::invalid_argument where a limit is not positive and finite or the workspace empty.
  explicit SafetyGate(const GateLimits& limits);
  GateOutput apply(const GateInputs& inputs) noexcept;
  /// The largest share of a twist that keeps speed and workspace.
  double share_within(const math::Twist& V_W_E, const math::Pose& X_WE, double dt) const noexcept;
  /// What leaves in the place of the last output; the next one goes on from it.
  void replace_last(const math::Twist& V_W_E) noexcept { last_ = V_W_E; }
  const math::Twist& last() const noexcept { return last_; }
  /// Force and torque may be up to their limits again; for start and reset. The command goes on
  /// from the last one, which may still be on its way to zero.
  void forget_overload() noexcept { overloaded_ = false; }

 private:
  struct Walls {  // how fast the hand may go on each axis
    Eigen::Vector3d lower, upper;
  };
  Walls walls(const math::Pose& X_WE, double dt) const noexcept;
  const char* refusal(const GateInputs& inputs) noexcept;
  math::Twist limited(const GateInputs& inputs, double dt, const char*& reason) const noexcept;
  math::Twist braked(double dt) const noexcept;

  GateLimits limits_;
  math::Twist last_;
  bool overloaded_ = false;
};

}  // namespace palpate::control
