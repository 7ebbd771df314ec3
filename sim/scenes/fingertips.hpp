#pragma once

#include <string>
#include <vector>

#include "sim/object/plant.hpp"
#include "sim/robot/robot.hpp"
#include "sim/sensors/biotac.hpp"

namespace palpate::scenes {

/// A link of the hand that carries a BioTac which touches the object.
struct Fingertip {
  std::string link;                                  // one of fingertips_of(robot)
  math::Pose X_LT = math::Pose::Identity();          // frame of core/sensing/biotac_geometry.hpp
  object::FingertipOptions sphere{7e-3, 0, 0, 0.8};  // about the origin of T
};

/// Links of the hand that carry a BioTac, in the order of HAND_STATE and BIOTAC_0 to BIOTAC_4;
/// those that the robot lacks are left out.
std::vector<std::string> fingertips_of(const robot::Robot& robot);

/// Carries motion from the robot's fingertips to the plant's and force from these back, both ways
/// without loss: a wrench that the plant exerts on a tip is what its link feels. `tips` are the
/// plant's, in its order; a finger is a place in fingertips_of(robot).
class FingertipCoupling {
 public:
  /// `X_WO`: where the object's frame stands. Throws std::invalid_argument where a link is no
  /// fingertip of the robot or is named twice.
  FingertipCoupling(std::vector<Fingertip> tips, const robot::Robot& robot, const math::Pose& X_WO);

  /// Sends the plant's tips to where the links are now, at their speed.
  void move(const robot::Robot& robot, object::Plant& plant) const;

  /// Puts the mean wrenches of the plant's last step on the links.
  void load(const object::Plant& plant, robot::Robot& robot) const;

  /// X_ET of every finger, with a tip in the plant or without.
  std::vector<math::Pose> poses_in_flange(const robot::Robot& robot) const;

  /// By finger, what its BioTac feels now; empty where the plant has no tips.
  std::vector<std::vector<sensors::Touch>> touches(const robot::Robot& robot,
                                                   const object::Plant& plant) const;

  int finger_count() const { return static_cast<int>(links_.size()); }
  int tip_count() const { return static_cast<int>(fingers_.size()); }
  int finger(int tip) const { return fingers_[tip]; }
  const std::string& link(int tip) const { return links_[fingers_[tip]]; }

 private:
  math::Pose tip_pose(int tip, const robot::Robot& robot) const;  // X_WT

  math::Pose X_WO_;
  std::vector<std::string> links_;  // by finger
  std::vector<math::Pose> X_LT_;    // by finger
  std::vector<int> fingers_;        // by tip of the plant
};

}  // namespace palpate::scenes
