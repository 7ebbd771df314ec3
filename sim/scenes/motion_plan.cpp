#include "sim/scenes/motion_plan.hpp"

#include <utility>

namespace palpate::scenes {

MotionPlan::MotionPlan(std::vector<Leg> legs, double start_delay)
    : legs_(std::move(legs)), start_delay_(start_delay), duration_(start_delay) {
  for (const Leg& leg : legs_) duration_ += leg.move + leg.hold;
}

MotionPoint MotionPlan::at(double time) const {
  MotionPoint point;
  double begin = start_delay_;
  for (const Leg& leg : legs_) {
    if (time <= begin) break;
    const Eigen::Matrix3d target = math::exp_rotation(leg.rotation);
    if (time < begin + leg.move) {
      const double x = (time - begin) / leg.move;
      const double share = x * x * x * (10 + x * (-15 + 6 * x));
      const double rate = 30 * x * x * (1 - x) * (1 - x) / leg.move;
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
  return point;
}

}  // namespace palpate::scenes
