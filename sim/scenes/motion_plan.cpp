#include "sim/scenes/motion_plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/random.hpp"

namespace palpate::scenes {

Wander::Wander(const WanderOptions& options) : options_(options) {
  math::Random random(options.seed, "wander");
  const double longest = std::log(options.longest), shortest = std::log(options.shortest);
  for (int i = 0; i < 6 * kWaves; ++i) {
    const double period = std::exp(random.uniform(shortest, longest));
    waves_.push_back({2 * M_PI / period, random.uniform(0, 2 * M_PI)});
  }
}

MotionPoint Wander::at(double time) const {
  MotionPoint point;
  const double left = options_.duration - time;
  if (time <= 0 || left <= 0) return point;
  const double rise = std::min(options_.rise, options_.duration / 2);
  double swell = 1, swell_rate = 0;
  if (std::min(time, left) < rise) {
    swell = minimum_jerk(std::min(time, left) / rise);
    swell_rate = std::copysign(minimum_jerk_rate(std::min(time, left) / rise) / rise, left - time);
  }
  math::Vector6d most, place, rate;
  most << options_.translation, options_.rotation;
  for (int axis = 0; axis < 6; ++axis) {
    double sum = 0, slope = 0;
    for (int i = axis * kWaves; i < (axis + 1) * kWaves; ++i) {
      sum += std::sin(waves_[i].omega * time + waves_[i].phase) / kWaves;
      slope += waves_[i].omega * std::cos(waves_[i].omega * time + waves_[i].phase) / kWaves;
    }
    place(axis) = most(axis) * swell * sum;
    rate(axis) = most(axis) * (swell * slope + swell_rate * sum);
  }
  point.translation = place.head<3>();
  point.rotation = math::exp_rotation(place.tail<3>());
  point.velocity.linear = rate.head<3>();
  point.velocity.angular = math::inverse_left_jacobian(place.tail<3>()).inverse() * rate.tail<3>();
  return point;
}

MotionPlan::MotionPlan(std::vector<Leg> legs, double start_delay, std::optional<Wander> wander)
    : legs_(std::move(legs)),
      start_delay_(start_delay),
      wander_(std::move(wander)),
      duration_(start_delay) {
  for (const Leg& leg : legs_) duration_ += leg.move + leg.hold;
  if (wander_) duration_ += wander_->duration();
}

MotionPoint MotionPlan::at(double time) const {
  MotionPoint point;
  double begin = start_delay_;
  for (const Leg& leg : legs_) {
    if (time <= begin) break;
    const Eigen::Matrix3d target = math::exp_rotation(leg.rotation);
    if (time < begin + leg.move) {
      const double x = (time - begin) / leg.move;
      const double share = minimum_jerk(x), rate = minimum_jerk_rate(x) / leg.move;
      const Eigen::Vector3d way = leg.translation - point.translation;
      const Eigen::Vector3d turn = math::log_rotation(target * point.rotation.transpose());
      point.translation += share * way;
      point.rotation = math::exp_rotation(share * turn) * point.rotation;
      point.velocity = {rate * way, rate * turn};
      return point;
    }
    point.translation = leg.translation;
    point.rotation = target;
    begin += leg.move + leg.hold;
  }
  if (wander_) {
    const MotionPoint drift = wander_->at(time - begin);
    point.translation += drift.translation;
    point.rotation = drift.rotation * point.rotation;
    point.velocity = drift.velocity;
  }
  return point;
}

}  // namespace palpate::scenes
