#include "sim/scenes/fingertips.hpp"

#include <algorithm>
#include <stdexcept>

namespace palpate::scenes {
namespace {

constexpr const char* kFingertips[] = {"ff_tip", "mf_tip", "rf_tip", "lf_tip", "th_tip"};

}  // namespace

std::vector<std::string> fingertips_of(const robot::Robot& robot) {
  std::vector<std::string> tips;
  for (const char* name : kFingertips)
    if (robot.has_link(name)) tips.push_back(name);
  return tips;
}

FingertipCoupling::FingertipCoupling(std::vector<Fingertip> tips, const robot::Robot& robot,
                                     const math::Pose& X_WO)
    : X_WO_(X_WO), links_(fingertips_of(robot)), X_LT_(links_.size(), math::Pose::Identity()) {
  for (const Fingertip& tip : tips) {
    const auto link = std::find(links_.begin(), links_.end(), tip.link);
    if (link == links_.end())
      throw std::invalid_argument("the robot has no fingertip named " + tip.link);
    const int finger = static_cast<int>(link - links_.begin());
    if (std::find(fingers_.begin(), fingers_.end(), finger) != fingers_.end())
      throw std::invalid_argument(tip.link + " is named twice");
    X_LT_[finger] = tip.X_LT;
    fingers_.push_back(finger);
  }
}

math::Pose FingertipCoupling::tip_pose(int tip, const robot::Robot& robot) const {
  return robot.link_pose(link(tip)) * X_LT_[fingers_[tip]];
}

void FingertipCoupling::move(const robot::Robot& robot, object::Plant& plant) const {
  const Eigen::Matrix3d R_OW = X_WO_.linear().transpose();
  for (int i = 0; i < tip_count(); ++i) {
    const math::Pose X_WL = robot.link_pose(link(i));
    const math::Twist V_W = math::move_reference(robot.link_twist(link(i)),
                                                 X_WL.linear() * X_LT_[fingers_[i]].translation());
    plant.move_fingertip(i, X_WO_.inverse() * tip_pose(i, robot).translation(),
                         {R_OW * V_W.linear, R_OW * V_W.angular});
  }
}

void FingertipCoupling::load(const object::Plant& plant, robot::Robot& robot) const {
  const Eigen::Matrix3d& R_WO = X_WO_.linear();
  for (int i = 0; i < tip_count(); ++i) {
    const math::Wrench on_tip = plant.fingertip_wrench(i);
    robot.set_link_load(link(i), {R_WO * on_tip.force, R_WO * on_tip.torque},
                        X_WO_ * plant.fingertip_centre(i));
  }
}

std::vector<math::Pose> FingertipCoupling::poses_in_flange(const robot::Robot& robot) const {
  std::vector<math::Pose> poses;
  for (int f = 0; f < finger_count(); ++f)
    poses.push_back(robot.flange_pose().inverse() * robot.link_pose(links_[f]) * X_LT_[f]);
  return poses;
}

std::vector<std::vector<sensors::Touch>> FingertipCoupling::touches(
    const robot::Robot& robot, const object::Plant& plant) const {
  if (fingers_.empty()) return {};
  std::vector<std::vector<sensors::Touch>> touches(links_.size());
  for (int i = 0; i < tip_count(); ++i) {
    const object::FingertipTouch& touch = plant.touch(i);
    if (!touch.touching) continue;
    const math::Pose X_TO = tip_pose(i, robot).inverse() * X_WO_;
    touches[fingers_[i]].push_back(
        {X_TO * touch.point, X_TO.linear() * touch.force, sensors::radius_of(touch.area)});
  }
  return touches;
}

}  // namespace palpate::scenes
