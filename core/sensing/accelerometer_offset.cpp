#include "core/sensing/accelerometer_offset.hpp"

#include <algorithm>

namespace palpate::sensing {

void AccelerometerOffset::follow(const Eigen::Vector3d& acceleration_S, double step,
                                 const Velocity& velocity) noexcept {
  // s, largest gap between two velocities; beyond it the clock has jumped
  constexpr double kLongestGap = 0.1;
  constexpr double kShortestMean = 0.03;  // s, limits the effect of the noise of two velocities
  if (!(memory_ > 0) || !(step > 0)) return;
  if (!velocity.linear.allFinite()) {
    pause();
    return;
  }
  const double gap = velocity.time - before_.time;
  const Eigen::Vector3d change = velocity.linear - before_.linear;
  const bool follows = has_velocity_ && gap >= 0 && gap < kLongestGap;
  before_ = velocity;
  has_velocity_ = true;
  if (!follows) return;
  age_ += step;
  // The changes of the velocity sum to its total change, regardless of delay and noise of each.
  const double over = std::max({step, kShortestMean, std::min(age_, memory_)});
  value_S_ += (step * (acceleration_S - value_S_) - velocity.R_WS.transpose() * change) / over;
}

void AccelerometerOffset::reset() noexcept {
  value_S_.setZero();
  age_ = 0;
  pause();
}

}  // namespace palpate::sensing
