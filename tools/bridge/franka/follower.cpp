#include "follower.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::franka_bridge {
namespace {

constexpr double kStep = 1e-3;         // s, cycle of the arm
constexpr double kShare = 0.9;         // of the limits of acceleration and jerk that is used
constexpr double kSpeedMargin = 0.02;  // rad/s, to the limits of speed

/// Towards an end at the distance `left`, rad.
double most_speed(const Limits::Speed& limits, double left) {
  const double by_position = std::sqrt(limits.slope * std::max(0.0, left)) - limits.offset;
  return std::max(0.0, std::min(limits.most, by_position) - kSpeedMargin);
}

}  // namespace

const Limits& fr3_limits() {
  static const Limits limits{{{{-2.7501, 2.7501, 2.62, 0.30, 12.0},
                               {-1.7918, 1.7918, 2.62, 0.20, 5.17},
                               {-2.9065, 2.9065, 2.62, 0.20, 7.0},
                               {-3.0481, -0.1458, 2.62, 0.30, 8.0},
                               {-2.8101, 2.8101, 5.26, 0.35, 34.0},
                               {0.54092, 4.5205, 4.18, 0.35, 11.0},
                               {-3.0196, 3.0196, 5.26, 0.35, 34.0}}},
                             10,
                             5000};
  return limits;
}

/// The acceleration is the largest from which it can return to zero, at the limit of jerk, when
/// the speed arrives: after a step at the acceleration a the speed changes by about
/// a^2 / (2 jerk) + a kStep / 2 in all.
double Follower::next(double wanted, double speed, double acceleration) const {
  const double jerk = kShare * limits_.jerk, most = kShare * limits_.acceleration;
  const double error = wanted - speed;
  const double left = std::abs(error);
  const double arriving = std::min(
      jerk * (std::sqrt(0.25 * kStep * kStep + 2 * left / jerk) - 0.5 * kStep), left / kStep);
  const double aim = std::copysign(std::min(arriving, most), error);
  const double change = std::clamp(aim - acceleration, -jerk * kStep, jerk * kStep);
  return speed + kStep * (acceleration + change);
}

Seven Follower::next(const Seven& wanted, const RobotState& state) const {
  double share = 1;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const Limits::Speed& limits = limits_.speed[i];
    const double left = wanted[i] > 0 ? limits.upper - state.q[i] : state.q[i] - limits.lower;
    const double most = most_speed(limits, left);
    if (std::abs(wanted[i]) > most) share = std::min(share, most / std::abs(wanted[i]));
  }
  Seven dq{};
  for (std::size_t i = 0; i < kJoints; ++i)
    dq[i] = next(share * wanted[i], state.dq_d[i], state.ddq_d[i]);
  return dq;
}

}  // namespace palpate::franka_bridge
