#pragma once

#include <vector>

#include "core/math/rigid.hpp"

namespace palpate::scenes {

/// One pose to go to and to stay at.
struct Leg {
  double move = 0;                                        // s
  double hold = 0;                                        // s
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m, from the initial grasp, in O
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();     // rotation vector, rad, in O
};

/// Where the grasp shall be and how fast it moves, relative to where it was at first, axes of O.
struct MotionPoint {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  math::Twist velocity;  // m/s, rad/s
};

/// A sequence of poses, joined by minimum-jerk motions (Flash and Hogan 1985) along straight lines
/// and about fixed axes.
class MotionPlan {
 public:
  /// `start_delay`: s before the first leg.
  MotionPlan(std::vector<Leg> legs, double start_delay);

  MotionPoint at(double time) const;
  double duration() const { return duration_; }  // s, with the last hold
  const std::vector<Leg>& legs() const { return legs_; }
  double start_delay() const { return start_delay_; }

 private:
  std::vector<Leg> legs_;
  double start_delay_;
  double duration_;
};

}  // namespace palpate::scenes
