#pragma once

#include <cstdint>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/scenes/motion_point.hpp"

namespace palpate::scenes {

struct WanderOptions {
  double duration = 10;  // s, with rise and fall
  double rise = 2;       // s, over which it begins and ends, at most half the duration
  std::uint64_t seed = 1;
  double shortest = 2, longest = 8;                       // s, periods of its waves
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m, most of each axis
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();     // rad, most of each component
};

/// A smooth motion that nobody planned, as when an arm is led by hand: each axis of translation and
/// rotation vector is a sum of waves of random period and phase, that swells at the start and dies
/// down at the end like a minimum-jerk move. It begins and ends at rest in the same pose.
class Wander {
 public:
  explicit Wander(const WanderOptions& options);

  /// `time`: s since it began; at rest before and after.
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

}  // namespace palpate::scenes
