#pragma once

#include <Eigen/Core>
#include <limits>

#include "core/math/axis_motion.hpp"

namespace palpate::control {

/// Limits of the norms of three components.
struct SmoothLimits {
  double speed = 1;         // m/s, rad/s
  double acceleration = 1;  // m/s^2, rad/s^2
  double jerk = 10;         // m/s^3, rad/s^3
};

/// Distances that are left on each axis; negative: beyond the wall.
struct Room {
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  Eigen::Vector3d below = Eigen::Vector3d::Constant(kNone);
  Eigen::Vector3d above = Eigen::Vector3d::Constant(kNone);
};

/// Commanded velocity of three axes that follows a goal with limited speed, acceleration and jerk.
/// Each axis has 1 / sqrt(3) of acceleration and jerk, so that the norms stay within them, and
/// approaches a wall only so fast that it can stop before it within both. The norm of the velocity
/// stays within the limit also while accelerations are taken back. Nothing allocates.
class SmoothAxes {
 public:
  explicit SmoothAxes(const SmoothLimits& limits);

  /// The velocity after `v`; `goal` within the speed limit. An axis that can no longer stop before
  /// its wall within the limits, because the hand was displaced or a stop was interrupted, brakes
  /// by `braked`, its next velocity by the stop profile. `at_wall`: set if a wall has slowed an
  /// axis down.
  Eigen::Vector3d advance(const Eigen::Vector3d& v, const Eigen::Vector3d& goal,
                          const Eigen::Vector3d& braked, const Room& room, double dt,
                          bool& at_wall) noexcept;
  /// The velocity has changed otherwise, from `before` to `now` within `dt`.
  void follow(const Eigen::Vector3d& before, const Eigen::Vector3d& now, double dt) noexcept;
  /// The velocity follows the stop profile: the next motion begins without acceleration.
  void rest() noexcept { acceleration_.setZero(); }

 private:
  double before_wall(int axis, double v, double wanted, const Room& room, double dt,
                     bool& is_stuck) const noexcept;

  math::AxisLimits axis_;
  double speed_;
  Eigen::Vector3d acceleration_ = Eigen::Vector3d::Zero();  // of the last step
};

}  // namespace palpate::control
