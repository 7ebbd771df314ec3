#pragma once

#include <algorithm>
#include <cmath>

// Commanded motion of one axis with limited acceleration and jerk, in steps of dt: its velocity v
// becomes v + a dt with the acceleration a, which changes by at most jerk * dt. Linear or angular:
// m or rad, and s.
namespace palpate::math {

struct AxisLimits {
  double acceleration = 1;  // > 0
  double jerk = 10;         // > 0
};

/// Velocity at which the acceleration `a` of the last step to `v` has been taken back to zero as
/// fast as the jerk allows.
inline double coasting_velocity(double v, double a, const AxisLimits& limits, double dt) noexcept {
  const double step = limits.jerk * dt, size = std::abs(a);
  const double n = std::floor(size / step);  // further steps with an acceleration
  return v + std::copysign(dt * (n * size - 0.5 * step * n * (n + 1)), a);
}

/// Acceleration of the next step, after one with `a`, which changes the velocity by `way` as soon
/// as the limits allow and, for a constant goal, without going beyond it.
inline double acceleration_towards(double way, double a, const AxisLimits& limits,
                                   double dt) noexcept {
  const double step = limits.jerk * dt, size = std::abs(way) / dt;
  // With n further steps, whose accelerations fall by `step` each, the velocity changes by
  // dt ((n + 1) a - step n (n + 1) / 2).
  const double n = std::floor(0.5 * (std::sqrt(1 + 8 * size / step) - 1));
  const double most = (size + 0.5 * step * n * (n + 1)) / (n + 1);
  const double wanted = std::copysign(std::min(most, limits.acceleration), way);
  return a + std::clamp(wanted - a, -step, step);
}

/// Distance, in the direction of positive velocities, in which an axis comes to rest from `v` and
/// `a` with the largest jerk; 0 if it comes to rest without further motion in that direction.
/// Three phases: the deceleration grows, stays, and goes.
inline double braking_distance(double v, double a, const AxisLimits& limits) noexcept {
  const double J = limits.jerk;
  if (v + a * std::abs(a) / (2 * J) <= 0) return 0;
  const double peak = std::min(std::sqrt(J * v + 0.5 * a * a), limits.acceleration);
  const double grows = (a + peak) / J;
  const double v1 = v + 0.5 * (a - peak) * grows;
  const double v2 = peak * peak / (2 * J);  // where the deceleration begins to go
  const double stays = std::max(0.0, (v1 - v2) / peak);
  return v * grows + 0.5 * a * grows * grows - J * grows * grows * grows / 6 +
         0.5 * (v1 + v2) * stays + v2 * peak / (3 * J);
}

}  // namespace palpate::math
