#include "core/control/smooth_axes.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::control {
namespace {

using Eigen::Vector3d;

constexpr int kHalvings = 12;  // of the search for a permitted acceleration

/// Largest share in [0, 1] that `is_permitted`, found by halving; 0 need not be.
template <class IsPermitted>
double largest_share(IsPermitted is_permitted) noexcept {
  if (is_permitted(1.0)) return 1;
  double lower = 0, upper = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (lower + upper);
    (is_permitted(middle) ? lower : upper) = middle;
  }
  return lower;
}

}  // namespace

SmoothAxes::SmoothAxes(const SmoothLimits& limits)
    : axis_{limits.acceleration / std::sqrt(3.0), limits.jerk / std::sqrt(3.0)},
      speed_(limits.speed) {}

/// Acceleration between braking and `wanted` with which the axis can still stop before its wall.
double SmoothAxes::before_wall(int axis, double v, double wanted, const Room& room, double dt,
                               bool& is_stuck) const noexcept {
  // Steps for which the hand may move on before the braking that was computed begins.
  constexpr double kMargin = 2;
  const double brakes = math::acceleration_towards(-v, acceleration_[axis], axis_, dt);
  const auto stops = [&](double a, double margin) {
    const double next = v + a * dt;
    const double up = math::braking_distance(next, a, axis_);
    const double down = math::braking_distance(-next, -a, axis_);
    const double way = margin * std::abs(next) * dt;
    return (up == 0 || up + way <= room.above[axis]) &&
           (down == 0 || down + way <= room.below[axis]);
  };
  const double share =
      largest_share([&](double part) { return stops(brakes + part * (wanted - brakes), kMargin); });
  is_stuck = share == 0 && !stops(brakes, 0);
  return share == 1 ? wanted : brakes + share * (wanted - brakes);
}

Vector3d SmoothAxes::advance(const Vector3d& v, const Vector3d& goal, const Vector3d& braked,
                             const Room& room, double dt, bool& at_wall) noexcept {
  Vector3d wanted, brakes;
  bool is_stuck[3] = {};
  for (int axis = 0; axis < 3; ++axis) {
    const double freely =
        math::acceleration_towards(goal[axis] - v[axis], acceleration_[axis], axis_, dt);
    wanted[axis] = before_wall(axis, v[axis], freely, room, dt, is_stuck[axis]);
    at_wall = at_wall || wanted[axis] != freely || is_stuck[axis];
    brakes[axis] = math::acceleration_towards(-v[axis], acceleration_[axis], axis_, dt);
  }
  const auto at = [&](double share) {
    return share == 1 ? wanted : Vector3d(brakes + share * (wanted - brakes));
  };
  // Axes need not arrive at their coasting velocities together: each may have its larger one.
  const auto stays_slow = [&](double share) {
    const Vector3d a = at(share), next = v + dt * a;
    Vector3d largest;
    for (int axis = 0; axis < 3; ++axis)
      largest[axis] = std::max(std::abs(next[axis]),
                               std::abs(math::coasting_velocity(next[axis], a[axis], axis_, dt)));
    return largest.norm() <= speed_ * (1 + 1e-12);
  };
  acceleration_ = at(largest_share(stays_slow));
  Vector3d next = v + dt * acceleration_;
  for (int axis = 0; axis < 3; ++axis) {
    if (!is_stuck[axis]) continue;
    next[axis] = braked[axis];
    acceleration_[axis] = 0;
  }
  return next;
}

void SmoothAxes::follow(const Vector3d& before, const Vector3d& now, double dt) noexcept {
  const Vector3d bound = Vector3d::Constant(axis_.acceleration);
  acceleration_ = ((now - before) / dt).cwiseMax(-bound).cwiseMin(bound);
}

}  // namespace palpate::control
