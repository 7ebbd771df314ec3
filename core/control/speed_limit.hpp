#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/rigid.hpp"

namespace palpate::control {

/// limit / |v| if |v| > limit, else 1; also exact if the squares overflow.
inline double factor_to_limit(const Eigen::Vector3d& v, double limit) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return 1;
  return std::min(1.0, limit / largest / (v / largest).norm());
}

/// Largest factor up to 1 by which the twist satisfies both limits.
inline double speed_factor(const math::Twist& V, double linear, double angular) noexcept {
  return std::min(factor_to_limit(V.linear, linear), factor_to_limit(V.angular, angular));
}

/// Scales the whole twist until both speeds satisfy their limits; the screw axis is unchanged.
inline math::Twist limit_speed(const math::Twist& V, double linear, double angular) noexcept {
  const double factor = speed_factor(V, linear, angular);
  return {factor * V.linear, factor * V.angular};
}

/// Maximum speed, m/s (rad/s), towards a wall at `distance` from which braking with `deceleration`
/// from the next step on still stops before it: v dt + v^2 / 2a = distance.
inline double approach_speed(double distance, double deceleration, double dt) noexcept {
  if (!(distance > 0)) return 0;
  const double step = deceleration * dt;
  return std::sqrt(step * step + 2 * deceleration * distance) - step;
}

}  // namespace palpate::control
