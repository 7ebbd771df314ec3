#pragma once

#include <cstdint>
#include <vector>

#include "core/math/rigid.hpp"
#include "sim/scenes/motion_point.hpp"

namespace palpate::scenes {

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

}  // namespace palpate::scenes
