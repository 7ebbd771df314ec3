#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/control/control_law.hpp"
#include "core/control/smooth_axes.hpp"

namespace palpate::control {

inline constexpr double kGateStopTime = 0.1;  // s, from full speed to rest

/// Time step used by a gate: 1 ms instead of an invalid one, 0.1 s at most.
inline double gate_step(double dt) noexcept {
  return std::isfinite(dt) && dt > 0 ? std::min(dt, 0.1) : 1e-3;
}

/// Limits of published commands, all for the flange E in W. `force`, `torque`: of the contact
/// wrench, above which the hand stops.
struct GateLimits : HandLimits {
  double linear_jerk = 0;   // m/s^3; 0: not limited
  double angular_jerk = 0;  // rad/s^3; 0: not limited
  GateLimits() {
    linear_speed = 0.10;
    force = 10.0;
    torque = 3.0;
    workspace_lower = {-1, -1, 0};
    workspace_upper = {1, 1, 1.5};
  }
};

struct GateInputs {
  double dt = 1e-3;
  bool active = false;  // false: the command ramps down to zero
  math::Twist requested_W_E;
  math::Pose X_WE = math::Pose::Identity();
  bool wrench_valid = false;
  math::Wrench contact;  // tared wrench at the wrist
};

struct GateOutput {
  math::Twist V_W_E;  // always finite and within limits
  /// Joint velocities that produce it, if joints are commanded.
  kinematics::SerialChain::Joints joint_velocity;
  bool limited = false;   // output differs from the request
  bool rejected = false;  // the request was not finite, or force or torque exceeded its limit
  const char* reason = "";
};

/// Last step before publication: limits, then a check that every number is finite.
///
/// - Speed limits scale the whole twist by one factor.
/// - The change since the last command respects the acceleration limits.
/// - With jerk limits, so does the change of the acceleration. Each axis then has 1 / sqrt(3) of
///   the limits of acceleration and jerk, and brakes before a wall of the workspace in time within
///   both. A stop is never delayed by them: while it ramps down, a command follows the profile
///   below, and the next motion begins without acceleration.
/// - The workspace acts as a velocity damper on each axis: the approach to a wall is limited by the
///   speed from which the acceleration limit can still stop; outside, only motion back is
///   permitted.
/// - A rejected or inactive command ramps down to zero within 100 ms, if necessary above the
///   acceleration limit. After an excessive force or torque, commands are rejected until it falls
///   below 90 % of its limit.
/// - A time step that is not positive and finite is rejected and counts as 1 ms; one above 0.1 s
///   counts as 0.1 s.
class SafetyGate {
 public:
  /// Throws std::invalid_argument if a limit is not positive and finite or the workspace is empty.
  explicit SafetyGate(const GateLimits& limits);
  GateOutput apply(const GateInputs& inputs) noexcept;
  /// Largest factor in [0, 1] by which a twist satisfies the limits of speed and workspace.
  double share_within(const math::Twist& V_W_E, const math::Pose& X_WE, double dt) const noexcept;
  /// Replaces the last output, from which the next one continues.
  void replace_last(const math::Twist& V_W_E) noexcept;
  const math::Twist& last() const noexcept { return last_; }
  /// Clears the latched overload of force and torque; for start and reset. The command continues
  /// from the last one, which may still be ramping down.
  void forget_overload() noexcept { overloaded_ = false; }

 private:
  struct Walls {  // speed limits of the hand on each axis
    Eigen::Vector3d lower, upper;
  };
  Walls walls(const math::Pose& X_WE, double dt) const noexcept;
  const char* reason_to_reject(const GateInputs& inputs) noexcept;
  math::Twist limited(const GateInputs& inputs, double dt, const char*& reason) noexcept;
  /// The next velocity of the origin towards `goal`, and of the rotation.
  Eigen::Vector3d next_linear(const Eigen::Vector3d& goal, const math::Pose& X_WE, double dt,
                              const char*& reason) noexcept;
  Eigen::Vector3d next_angular(const Eigen::Vector3d& goal, double dt) noexcept;
  math::Twist braked(double dt) const noexcept;

  GateLimits limits_;
  std::optional<SmoothAxes> linear_, angular_;  // with a jerk limit
  math::Twist last_, before_;                   // outputs of the last two steps
  double last_step_ = 1e-3;                     // s
  bool overloaded_ = false;
};

}  // namespace palpate::control
