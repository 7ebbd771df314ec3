#include "rt/component/frames.hpp"

namespace palpate::component {

Frames read_frames(const config::Node& root) {
  const config::Node node = root.child_or_empty("frames");
  Frames frames;
  frames.X_WO = node.pose("object_in_base");
  frames.X_ES = node.pose("sensor_in_flange");
  frames.X_EI = node.pose("imu_in_flange");
  frames.X_EG = node.pose("grasp_in_flange");
  frames.gravity_W = node.vector3("gravity_in_base", {-20, 20}, frames.gravity_W);
  for (const config::Node& item : node.list("fingertips_in_object")) {
    const int finger = item.integer("finger", {0, 4});
    frames.X_OT[finger] = item.pose("pose");
  }
  return frames;
}

std::optional<Frames> read_second_frames(const config::Node& root) {
  if (!root.has("second_arm")) return std::nullopt;
  const config::Node arm = root.child("second_arm");
  const config::Node node = arm.child("frames");
  if (node.has("fingertips_in_object"))
    node.fail("fingertips_in_object", "fingertips are those of the first arm");
  for (const char* key : {"object_in_base", "grasp_in_flange"})
    if (!node.has(key)) node.fail(key, "is missing");
  return read_frames(arm);
}

}  // namespace palpate::component
