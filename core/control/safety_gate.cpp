#include "core/control/safety_gate.hpp"

#include <cmath>
#include <string>

#include "core/math/option_check.hpp"

namespace palpate::control {
namespace {

using Eigen::Vector3d;

constexpr double kRelease = 0.9;  // fraction of the limits of force and torque

bool is_finite(const math::Twist& V) { return V.linear.allFinite() && V.angular.allFinite(); }

/// `to`, or the point at distance `reach` from `from` on the line to it.
Vector3d step_towards(const Vector3d& from, const Vector3d& to, double reach) {
  const Vector3d way = to - from;
  const double length = way.norm();
  return length <= reach ? to : Vector3d(from + way * (reach / length));
}

/// Last point on the line from `base` to `goal` within `radius` of `centre`. `base` must be within.
Vector3d advance(const Vector3d& centre, const Vector3d& base, const Vector3d& goal,
                 double radius) {
  if ((goal - centre).norm() <= radius) return goal;
  const Vector3d way = goal - base;
  const Vector3d offset = base - centre;
  const double a = way.squaredNorm();
  if (!(a > 0)) return base;
  const double b = way.dot(offset);
  const double c = std::min(0.0, offset.squaredNorm() - radius * radius);
  return base + way * std::max(0.0, (std::sqrt(b * b - a * c) - b) / a);
}

}  // namespace

SafetyGate::SafetyGate(const GateLimits& limits) : limits_(limits) {
  math::check_all_finite(limits.workspace_lower, "gate.workspace.lower");
  math::check_all_finite(limits.workspace_upper, "gate.workspace.upper");
  limits.check("gate.", 1e6);
  math::check_not_negative(limits.linear_jerk, "gate.linear_jerk");
  math::check_not_negative(limits.angular_jerk, "gate.angular_jerk");
  if (limits.linear_jerk > 0)
    linear_.emplace(
        SmoothLimits{limits.linear_speed, limits.linear_acceleration, limits.linear_jerk});
  if (limits.angular_jerk > 0)
    angular_.emplace(
        SmoothLimits{limits.angular_speed, limits.angular_acceleration, limits.angular_jerk});
}

GateOutput SafetyGate::apply(const GateInputs& inputs) noexcept {
  const double dt = gate_step(inputs.dt);

  GateOutput output;
  const char* rejection = reason_to_reject(inputs);
  if (!inputs.active || rejection != nullptr)
    for (std::optional<SmoothAxes>* axes : {&linear_, &angular_})
      if (*axes) (*axes)->rest();
  if (!inputs.active) {
    output.V_W_E = braked(dt);
    output.reason = "inactive";
  } else if (rejection != nullptr) {
    output.V_W_E = braked(dt);
    output.rejected = true;
    output.reason = rejection;
  } else {
    output.V_W_E = limited(inputs, dt, output.reason);
  }

  if (!is_finite(output.V_W_E)) {
    output = GateOutput();
    output.rejected = true;
    output.reason = "command is not finite";
  }
  output.limited = output.V_W_E.linear != inputs.requested_W_E.linear ||
                   output.V_W_E.angular != inputs.requested_W_E.angular;
  before_ = last_;
  last_ = output.V_W_E;
  last_step_ = dt;
  return output;
}

void SafetyGate::replace_last(const math::Twist& V_W_E) noexcept {
  last_ = V_W_E;
  if (linear_) linear_->follow(before_.linear, last_.linear, last_step_);
  if (angular_) angular_->follow(before_.angular, last_.angular, last_step_);
}

/// Reason for rejecting the request, or nullptr.
const char* SafetyGate::reason_to_reject(const GateInputs& inputs) noexcept {
  if (inputs.wrench_valid) {
    const double force = inputs.contact.force.stableNorm();
    const double torque = inputs.contact.torque.stableNorm();
    if (!std::isfinite(force) || !std::isfinite(torque)) return "contact wrench is not finite";
    const double factor = overloaded_ ? kRelease : 1.0;
    overloaded_ = force > factor * limits_.force || torque > factor * limits_.torque;
  }
  if (overloaded_) return "contact force or torque is above its limit";
  if (!(std::isfinite(inputs.dt) && inputs.dt > 0)) return "time step is not positive and finite";
  if (!is_finite(inputs.requested_W_E)) return "requested twist is not finite";
  if (!inputs.X_WE.matrix().allFinite()) return "pose of the flange is not finite";
  return nullptr;
}

SafetyGate::Walls SafetyGate::walls(const math::Pose& X_WE, double dt) const noexcept {
  // all three axes may have to brake simultaneously within the limit of the norm
  const double deceleration = limits_.linear_acceleration / std::sqrt(3.0);
  const Vector3d p = X_WE.translation();
  Walls walls;
  for (int axis = 0; axis < 3; ++axis) {
    walls.lower[axis] = -approach_speed(p[axis] - limits_.workspace_lower[axis], deceleration, dt);
    walls.upper[axis] = approach_speed(limits_.workspace_upper[axis] - p[axis], deceleration, dt);
  }
  return walls;
}

double SafetyGate::share_within(const math::Twist& V, const math::Pose& X_WE,
                                double dt) const noexcept {
  double share = speed_factor(V, limits_.linear_speed, limits_.angular_speed);
  const Walls walls = this->walls(X_WE, gate_step(dt));
  for (int axis = 0; axis < 3; ++axis) {
    const double v = V.linear[axis], most = v > 0 ? walls.upper[axis] : -walls.lower[axis];
    if (std::abs(v) > most) share = std::min(share, most / std::abs(v));
  }
  return share;
}

/// Limits speed, then workspace, then acceleration. The last step moves from the old command,
/// clamped to the bounds, towards the new one: both lie within the convex bounds, and so does every
/// point between them.
math::Twist SafetyGate::limited(const GateInputs& inputs, double dt, const char*& reason) noexcept {
  math::Twist goal = limit_speed(inputs.requested_W_E, limits_.linear_speed, limits_.angular_speed);
  if (goal.linear != inputs.requested_W_E.linear || goal.angular != inputs.requested_W_E.angular) {
    reason = "speed";
  }
  const math::Twist V{next_linear(goal.linear, inputs.X_WE, dt, reason),
                      next_angular(goal.angular, dt)};
  if (V.angular != goal.angular) reason = angular_ ? "acceleration or jerk" : "acceleration";
  return V;
}

Vector3d SafetyGate::next_linear(const Vector3d& goal, const math::Pose& X_WE, double dt,
                                 const char*& reason) noexcept {
  if (linear_) {
    const Vector3d p = X_WE.translation();
    bool at_wall = false;
    const Vector3d V =
        linear_->advance(last_.linear, goal, braked(dt).linear,
                         {p - limits_.workspace_lower, limits_.workspace_upper - p}, dt, at_wall);
    if (V != goal) reason = at_wall ? "workspace" : "acceleration or jerk";
    return V;
  }
  const Walls walls = this->walls(X_WE, dt);
  const Vector3d &lower = walls.lower, &upper = walls.upper;
  const Vector3d inside = goal.cwiseMax(lower).cwiseMin(upper);
  if (inside != goal) reason = "workspace";

  const double reach = limits_.linear_acceleration * dt;
  const Vector3d base =
      step_towards(last_.linear, last_.linear.cwiseMax(lower).cwiseMin(upper), reach);
  const Vector3d V = advance(last_.linear, base, inside, reach);
  if (V != inside) reason = "acceleration";
  return V;
}

Vector3d SafetyGate::next_angular(const Vector3d& goal, double dt) noexcept {
  if (!angular_) return step_towards(last_.angular, goal, limits_.angular_acceleration * dt);
  bool at_wall = false;
  return angular_->advance(last_.angular, goal, braked(dt).angular, {}, dt, at_wall);
}

/// Each axis ramps down independently: along a common line, an axis with a small share of the speed
/// would brake more slowly than the workspace damper assumes.
math::Twist SafetyGate::braked(double dt) const noexcept {
  const double root3 = std::sqrt(3.0);
  const double linear =
      std::max(limits_.linear_acceleration / root3, limits_.linear_speed / kGateStopTime);
  const double angular =
      std::max(limits_.angular_acceleration / root3, limits_.angular_speed / kGateStopTime);
  const auto ramp = [dt](const Vector3d& v, double rate) {
    const Vector3d bound = Vector3d::Constant(rate * dt);
    return Vector3d(v - v.cwiseMax(-bound).cwiseMin(bound));
  };
  return {ramp(last_.linear, linear), ramp(last_.angular, angular)};
}

}  // namespace palpate::control
