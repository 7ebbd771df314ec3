#pragma once

#include <optional>
#include <vector>

#include "sim/scenes/motion_point.hpp"
#include "sim/scenes/wander.hpp"

namespace palpate::scenes {

/// A target pose, with the durations of move and hold.
struct Leg {
  double move = 0;                                        // s
  double hold = 0;                                        // s
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m, from the initial grasp, in O
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();     // rotation vector, rad, in O
};

/// A sequence of poses, joined by minimum-jerk motions along straight lines and about fixed axes;
/// then, optionally, a random motion (wander) about the last of them.
class MotionPlan {
 public:
  /// `start_delay`: s before the first leg.
  MotionPlan(std::vector<Leg> legs, double start_delay, std::optional<Wander> wander = {});

  MotionPoint at(double time) const;
  double duration() const { return duration_; }  // s, including the last hold and the wander
  const std::vector<Leg>& legs() const { return legs_; }
  double start_delay() const { return start_delay_; }

 private:
  std::vector<Leg> legs_;
  double start_delay_;
  std::optional<Wander> wander_;
  double duration_;
};

}  // namespace palpate::scenes
