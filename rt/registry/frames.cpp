#include "rt/registry/frames.hpp"

namespace palpate::registry {

Frames read_frames(const config::Node& root) {
  const config::Node node =
      root.child_or_empty({"frames", "",
                           "where things are: W robot base, E flange, S force-torque sensor, I "
                           "inertial unit, G grasp, O object, T fingertip"});
  Frames frames;
  frames.X_WO = node.pose({"object_in_base", "m", "X_WO, of the mesh at rest"});
  frames.X_ES = node.pose({"sensor_in_flange", "m", "X_ES"});
  frames.X_EI = node.pose({"imu_in_flange", "m", "X_EI"});
  frames.X_EG = node.pose({"grasp_in_flange", "m", "X_EG, of the grasp that holds the object"});
  frames.gravity_W =
      node.vector3({"gravity_in_base", "m/s^2", "gravity in W"}, {-20, 20}, frames.gravity_W);
  for (const config::Node& item : node.list(
           {"fingertips_in_object", "", "where fingertips are while HAND_STATE does not tell"})) {
    const int finger = item.integer({"finger", "", "which fingertip"}, {0, 4});
    frames.X_OT[finger] = item.pose({"pose", "m", "X_OT"});
  }
  return frames;
}

std::optional<Frames> read_second_frames(const config::Node& root) {
  if (!root.has("second_arm")) return std::nullopt;
  const config::Node arm = root.child(
      {"second_arm", "", "an arm that holds the object as well, on channels with the suffix _1"});
  const config::Node node = arm.child({"frames", "",
                                       "where things are: W robot base, E flange, S force-torque "
                                       "sensor, I inertial unit, G grasp, O object, T fingertip"});
  if (node.has("fingertips_in_object"))
    node.fail("fingertips_in_object", "fingertips are those of the first arm");
  for (const char* key : {"object_in_base", "grasp_in_flange"})
    if (!node.has(key)) node.fail(key, "is missing");
  return read_frames(arm);
}

}  // namespace palpate::registry
