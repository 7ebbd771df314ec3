#include "sim/scenes/motion_plan.hpp"

#include <utility>

namespace palpate::scenes {

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
    const MotionPoint beside = wander_->at(time - begin);
    point.translation += beside.translation;
    point.rotation = beside.rotation * point.rotation;
    point.velocity = beside.velocity;
  }
  return point;
}

}  // namespace palpate::scenes
