#include "core/estimation/rest_detector.hpp"

#include <algorithm>

namespace palpate::estimation {
namespace {

constexpr double kAveragingTime = 0.1;   // s, averaging time of the displacement
constexpr double kRadiansPerMetre = 10;  // a hand turns about points at a distance of 0.1 m

bool is_beyond(const math::Vector6d& displacement, double distance) noexcept {
  return displacement.head<3>().norm() > distance ||
         displacement.tail<3>().norm() > kRadiansPerMetre * distance;
}

}  // namespace

void RestDetector::reset() noexcept {
  hands_.fill(Hand());
  rest_time_ = 0;
}

void RestDetector::update(const std::array<GraspInput, 2>& grasps, int count, double dt) noexcept {
  bool moves = false;
  for (int i = 0; i < count; ++i) moves = has_moved(hands_[i], grasps[i].X_OG, dt) || moves;
  rest_time_ = moves ? 0 : rest_time_ + dt;
}

bool RestDetector::has_moved(Hand& hand, const math::Pose& X_OG, double dt) const noexcept {
  if (!X_OG.matrix().allFinite()) return false;
  math::Pose& rest = hand.X_OG_rest;
  math::Vector6d displacement;
  displacement << X_OG.translation() - rest.translation(),
      math::log_rotation(X_OG.linear() * rest.linear().transpose());
  if (is_beyond(displacement, options_.rest_distance)) {
    rest = X_OG;
    hand.displacement.setZero();
    return true;
  }
  hand.displacement += std::min(1.0, dt / kAveragingTime) * (displacement - hand.displacement);
  return is_beyond(displacement - hand.displacement, options_.rest_recently);
}

}  // namespace palpate::estimation
