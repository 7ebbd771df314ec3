#pragma once

#include <cstdint>
#include <optional>
#include <vector>

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

struct WanderOptions {
  double duration = 10;  // s, including rise and fall
  double rise = 2;       // s, duration of fade-in and fade-out, at most half the duration
  std::uint64_t seed = 1;
  double shortest = 2, longest = 8;                       // s, periods of its waves
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m, largest amplitude per axis
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();     // rad, largest amplitude per component
};

/// A smooth random motion, as when an arm is guided by hand: each axis of translation and rotation
/// vector is a sum of sine waves of random period and phase, faded in and out like a minimum-jerk
/// move. It begins and ends at rest in the same pose.
class Wander {
 public:
  explicit Wander(const WanderOptions& options);

  /// `time`: s since its start; at rest before and after.
  MotionPoint at(double time) const;
  double duration() const { return options_.duration; }

 private:
  static constexpr int kWaves = 5;
  struct Wave {
    double omega = 0, phase = 0;  // rad/s, rad
  };

  WanderOptions options_;
  std::vector<Wave> waves_;  // kWaves for each of six axes
};

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
