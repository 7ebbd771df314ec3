#pragma once

#include <array>
#include <optional>

#include "core/math/rigid.hpp"
#include "rt/config/node.hpp"

namespace palpate::registry {

/// Constant transforms of one arm in its workcell, from the section `frames`. W is the base of that
/// arm.
struct Frames {
  math::Pose X_WO = math::Pose::Identity();  // object's rest frame in the robot base
  math::Pose X_ES = math::Pose::Identity();  // pose of the force-torque sensor in the flange
  math::Pose X_EI = math::Pose::Identity();  // pose of the IMU in the flange
  math::Pose X_EG = math::Pose::Identity();  // pose of the grasp in the flange
  Eigen::Vector3d gravity_W{0, 0, -9.81};    // m/s^2
  /// Poses of fingertips that are fixed in O, for a workcell without hand state.
  std::array<std::optional<math::Pose>, 5> X_OT;
};

/// Reads `frames`; throws config::Error.
Frames read_frames(const config::Node& root);

/// Reads `second_arm.frames`; empty without `second_arm`. Throws config::Error.
std::optional<Frames> read_second_frames(const config::Node& root);

}  // namespace palpate::registry
