#include "sim/scenes/camera_settings.hpp"

#include <stdexcept>

namespace palpate::scenes {
namespace {

constexpr double kFarthest = 20;  // m
const Eigen::Vector3d kAmber(0.95, 0.72, 0.30);

math::Pose read_pose(const config::Node& node, const Eigen::Vector3d& middle_W) {
  if (node.has("pose")) {
    if (node.has("eye")) node.fail("eye", "given together with pose; allowed: one of them");
    return node.pose({"pose", "m", "X_WC, z forwards; in place of eye and target"});
  }
  const Eigen::Vector3d eye =
      node.vector3({"eye", "m", "where it stands, in W"}, {-kFarthest, kFarthest});
  const Eigen::Vector3d target =
      node.vector3({"target", "m", "where it looks, in W; by default amid the object"},
                   {-kFarthest, kFarthest}, middle_W);
  try {
    return draw::look_at(eye, target, Eigen::Vector3d::UnitZ());
  } catch (const std::invalid_argument&) {
    node.fail("eye", "lies above, below or in the target; allowed: elsewhere, or pose instead");
  }
}

}  // namespace

camera::ShapeCameraOptions read_camera(const config::Node& node, const Scene& scene) {
  const Eigen::Vector3d lower = scene.plant.origin, upper = lower + scene.plant.size;
  camera::ShapeCameraOptions options;
  options.X_WC = read_pose(node, scene.X_WO * Eigen::Vector3d(0.5 * (lower + upper)));
  options.noise = scene.sensors.camera.noise;
  options.calibration_error = scene.sensors.camera.calibration_error;
  if (node.choice(
          {"segmentation", "",
           "how the object is distinguished from the rest: by colour and box, or by the truth"},
          {"colour", "truth"}, "colour") == "truth")
    options.segmentation = camera::Segmentation::kTruth;

  camera::ObjectFilter& filter = options.filter;
  filter.X_WB = scene.X_WO;
  const double about = 0.5 * scene.plant.size.maxCoeff();
  const config::Node box =
      node.child_or_empty({"box", "", "about the object, in O; what is seen outside is not of it"});
  filter.lower = box.vector3({"lower", "m", "lowest corner"}, {}, lower.array() - about);
  filter.upper = box.vector3({"upper", "m", "highest corner"}, {}, upper.array() + about);
  const Eigen::Vector3f colour =
      node.vector3({"colour", "", "of the object: red, green, blue"}, {0, 1}, kAmber).cast<float>();
  if (!(colour.sum() > 0.2F)) node.fail("colour", "too dark to be distinguished from black");
  filter.colour = {colour.x(), colour.y(), colour.z(), 1};
  filter.tolerance = node.number({"tolerance", "", "of its hue"}, {0.001, 1}, filter.tolerance);
  options.margin = node.integer({"margin", "pixels", "taken off the rim of what is seen"}, {0, 50},
                                options.margin);
  options.voxel =
      node.number({"voxel", "m", "of which one point is published"}, {0.001, 1}, options.voxel);
  return options;
}

std::vector<Occlusion> read_occlusions(const config::Node& node) {
  std::vector<Occlusion> occlusions;
  for (const config::Node& item : node.list({"occlusions", "", "times in which nothing is seen"})) {
    const double free = occlusions.empty() ? 0 : occlusions.back().at + occlusions.back().duration;
    Occlusion occlusion;
    occlusion.at = item.number({"at", "s", "simulated time"}, {free, 1e5});
    occlusion.duration = item.number({"duration", "s", "of it"}, {0.001, 1e5});
    occlusions.push_back(occlusion);
  }
  return occlusions;
}

}  // namespace palpate::scenes
