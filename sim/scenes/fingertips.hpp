#pragma once

#include <string>
#include <vector>

#include "sim/object/plant.hpp"
#include "sim/robot/robot.hpp"
#include "sim/sensors/biotac.hpp"

namespace palpate::scenes {

/// A link of the hand with a BioTac that touches the object.
struct Fingertip {
  std::string link;                                  // one of fingertips_of(robot)
  math::Pose X_LT = math::Pose::Identity();          // frame of core/sensing/biotac_geometry.hpp
  object::FingertipOptions sphere{7e-3, 0, 0, 0.8};  // about the origin of T
};

/// Links of the hand with a BioTac, in the order of HAND_STATE and BIOTAC_0 to BIOTAC_4; links that
/// the robot lacks are omitted.
std::vector<std::string> fingertips_of(const robot::Robot& robot);

/// Transfers motion from the robot's fingertips to the plant's and forces back, consistently in
/// both directions: the wrench of the plant on a tip acts on its link. `tips` are the plant's, in
/// its order; a finger is an index into fingertips_of(robot).
class FingertipCoupling {
 public:
  /// `X_WO`: pose of the object's frame. Throws std::invalid_argument if a link is not a fingertip
  /// of the robot or is named twice.
  FingertipCoupling(std::vector<Fingertip> tips, const robot::Robot& robot, const math::Pose& X_WO);

  /// Moves the plant's tips to the current poses of the links, with their velocities.
  void move(const robot::Robot& robot, object::Plant& plant) const;

  /// Applies the mean wrenches of the plant's last step to the links.
  void load(const object::Plant& plant, robot::Robot& robot) const;

  /// X_ET of every finger, with or without a tip in the plant.
  std::vector<math::Pose> poses_in_flange(const robot::Robot& robot) const;

  /// Contacts on each finger's BioTac now; empty if the plant has no tips.
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
