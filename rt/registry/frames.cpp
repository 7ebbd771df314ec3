#include "rt/registry/frames.hpp"

namespace palpate::registry {
namespace {

const config::Key kFrames("frames", "",
                          "Poses of the workcell's frames: W robot base, E flange, S force-torque "
                          "sensor, I inertial unit, G grasp, O object, T fingertip");

}  // namespace

Frames read_frames(const config::Node& root) {
  const config::Node node = root.child_or_empty(kFrames);
  Frames frames;
  frames.X_WO = node.pose({"object_in_base", "m", "X_WO, pose of the mesh at rest"});
  frames.X_ES = node.pose({"sensor_in_flange", "m", "X_ES, pose of the force-torque sensor"});
  frames.X_EI = node.pose({"imu_in_flange", "m", "X_EI, pose of the inertial unit"});
  frames.X_EG =
      node.pose({"grasp_in_flange", "m", "X_EG, pose of the grasp that holds the object"});
  frames.gravity_W = node.vector3({"gravity_in_base", "m/s^2", "Gravitational acceleration in W"},
                                  {-20, 20}, frames.gravity_W);
  for (const config::Node& item :
       node.list({"fingertips_in_object", "", "Poses of fingertips without hand state"})) {
    const int finger = item.integer({"finger", "", "Index of the fingertip"}, {0, 4});
    frames.X_OT[finger] = item.pose({"pose", "m", "X_OT, pose of the fingertip"});
  }
  return frames;
}

std::optional<Frames> read_second_frames(const config::Node& root) {
  if (!root.has("second_arm")) return std::nullopt;
  const config::Node arm =
      root.child({"second_arm", "",
                  "Second arm that holds the object as well, on channels with the suffix _1"});
  const config::Node node = arm.child(kFrames);
  if (node.has("fingertips_in_object"))
    node.fail("fingertips_in_object", "fingertips belong to the first arm");
  for (const char* key : {"object_in_base", "grasp_in_flange"})
    if (!node.has(key)) node.fail(key, "is missing; allowed: a pose");
  return read_frames(arm);
}

}  // namespace palpate::registry
