#pragma once

#include "core/math/rigid.hpp"

namespace palpate::scenes {

/// Target pose and velocity of the grasp relative to its initial pose, axes of O.
struct MotionPoint {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  math::Twist velocity;  // m/s, rad/s
};

/// Completed fraction of a minimum-jerk move (Flash and Hogan 1985) at the fraction x, 0 to 1, of
/// its time.
inline double minimum_jerk(double x) { return x * x * x * (10 + x * (-15 + 6 * x)); }
/// Its derivative with respect to x.
inline double minimum_jerk_rate(double x) { return 30 * x * x * (1 - x) * (1 - x); }

}  // namespace palpate::scenes
