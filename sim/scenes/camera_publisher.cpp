#include "sim/scenes/camera_publisher.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <palpate/channels.hpp>
#include <stdexcept>
#include <utility>

#include "sim/camera/point_cloud_message.hpp"

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
  const Eigen::Vector3d target = node.vector3(
      {"target", "m",
       "Point that the camera is directed at, in W; default: the middle of the object"},
      {-kFarthest, kFarthest}, middle_W);
  try {
    return draw::look_at(eye, target, Eigen::Vector3d::UnitZ());
  } catch (const std::invalid_argument&) {
    node.fail("eye", "lies above, below or in the target; allowed: elsewhere, or pose instead");
  }
}

constexpr double kRigThickness = 0.03;  // m
constexpr double kRigOverhang = 1.6;    // side lengths relative to those of the face
const draw::Colour kRigColour{0.35F, 0.37F, 0.40F, 1};

draw::TriangleMesh mesh_of(const robot::VisualShape& visual) {
  switch (visual.kind) {
    case robot::ShapeKind::kBox:
      return draw::make_box(visual.size);
    case robot::ShapeKind::kCylinder:
      return draw::make_cylinder(visual.size.x(), visual.size.y());
    case robot::ShapeKind::kSphere:
      return draw::make_sphere(visual.size.x());
  }
  return {};
}

camera::Body make_body(draw::TriangleMesh mesh, const math::Pose& X, const draw::Colour& colour,
                       bool is_object = false) {
  return {std::make_shared<const draw::TriangleMesh>(std::move(mesh)), X, colour, is_object};
}

/// In O; none if the clamp is not a face of the box.
std::optional<camera::Body> rig(const object::PlantOptions& plant) {
  if (!plant.clamp) return std::nullopt;
  const Eigen::Vector3d lower = plant.origin, upper = plant.origin + plant.size;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool is_upper : {false, true}) {
      const double face = is_upper ? upper[axis] : lower[axis];
      if (plant.clamp->lower[axis] != face || plant.clamp->upper[axis] != face) continue;
      Eigen::Vector3d size = kRigOverhang * plant.size, centre = 0.5 * (lower + upper);
      size[axis] = kRigThickness;
      centre[axis] = face + (is_upper ? 0.5 : -0.5) * kRigThickness;
      return make_body(draw::make_box(size), math::make_pose(Eigen::Matrix3d::Identity(), centre),
                       kRigColour);
    }
  }
  return std::nullopt;
}

constexpr int kMostPoints =
    sizeof(shape_observation_t::points) / sizeof(shape_observation_t::points[0]);
constexpr int kDefaultStride = 4;  // px: 160 x 120 points, 307 kB
constexpr const char* kCloudFrame = "camera";

config::Node cloud_section(const config::Node& node) {
  return node.child_or_empty({"cloud", "", "of all that the camera sees, drake/lcmt_point_cloud"});
}

}  // namespace

camera::ShapeCameraOptions read_camera(const config::Node& node, const Scene& scene) {
  const Eigen::Vector3d lower = scene.plant.origin, upper = lower + scene.plant.size;
  camera::ShapeCameraOptions options;
  options.X_WC = read_pose(node, scene.X_WO * Eigen::Vector3d(0.5 * (lower + upper)));
  options.noise = scene.sensors.camera.noise;
  options.calibration_error = scene.sensors.camera.calibration_error;
  // Clouds cost time: a scene that is scored by the truth sends them on request alone.
  options.has_shape = node.flag(
      {"truth_segmentation", "",
       "whether the simulator, which knows the object, publishes its points in SHAPE_OBSERVATION; "
       "for scoring: in place of palpate-see, and of clouds unless `cloud` is given"},
      false);
  options.cloud_stride =
      cloud_section(node).integer({"stride", "pixels", "between the points of a cloud"}, {1, 16},
                                  options.has_shape && !node.has("cloud") ? 0 : kDefaultStride);
  if (node.choice({"segmentation", "",
                   "with truth_segmentation: by colour within the box, or by the rendered body"},
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

std::string read_cloud_channel(const config::Node& node) {
  const config::Node cloud = cloud_section(node);
  const std::string channel = cloud.text({"channel", "", "of the clouds"}, "POINT_CLOUD");
  const bool is_valid =
      !channel.empty() && channel.size() <= bus::kLongestChannel &&
      channel.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == std::string::npos;
  if (!is_valid) cloud.fail("channel", channel + "; allowed: 1 to 63 of A to Z, 0 to 9 and _");
  return channel;
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

bool is_occluded(const std::vector<Occlusion>& occlusions, std::int64_t now_us) {
  const double now = 1e-6 * static_cast<double>(now_us);
  return std::any_of(occlusions.begin(), occlusions.end(), [now](const Occlusion& occlusion) {
    return now >= occlusion.at && now < occlusion.at + occlusion.duration;
  });
}

shape_observation_t make_observation(const Eigen::Matrix3Xd& points_W, double deviation) {
  shape_observation_t message{};
  const Eigen::Matrix3Xf points = points_W.cast<float>();
  message.count = static_cast<std::int32_t>(points.cols());
  message.deviation = deviation;
  for (int i = 0; i < message.count; ++i)
    Eigen::Map<Eigen::Vector3f>(message.points[i]) = points.col(i);
  return message;
}

CameraScenery::CameraScenery(const Scene& scene, const std::vector<Arm>& arms)
    : X_WO_(scene.X_WO), object_colour_(scene.camera->filter.colour) {
  for (std::size_t i = 0; i < arms.size(); ++i) {
    for (const robot::VisualShape& visual : arms[i].robot().visuals()) {
      const Eigen::Vector3f c = visual.colour.cast<float>();
      visuals_.push_back(
          {i, visual.link, make_body(mesh_of(visual), visual.X_LV, {c.x(), c.y(), c.z(), 1})});
    }
  }
  if (std::optional<camera::Body> block = rig(scene.plant)) {
    block->X_WB = X_WO_ * block->X_WB;
    still_.push_back(*block);
  }
}

std::vector<camera::Body> CameraScenery::now(const std::vector<Arm>& arms,
                                             const object::Plant& plant) const {
  std::vector<camera::Body> bodies = still_;
  for (const Visual& visual : visuals_) {
    const Arm& arm = arms[visual.arm];
    const math::Pose X_base = X_WO_ * arm.scene().X_WO.inverse();
    bodies.push_back(visual.body);
    bodies.back().X_WB = X_base * arm.robot().link_pose(visual.link) * visual.body.X_WB;
  }
  bodies.push_back(
      make_body({plant.positions(), plant.surface_triangles()}, X_WO_, object_colour_, true));
  return bodies;
}

CameraPublisher::CameraPublisher(bus::MessageBus& control, CloudSink clouds, const Scene& scene,
                                 const std::vector<Arm>& arms, std::int64_t session,
                                 std::int64_t start_utime)
    : channel_(scene.sensors.camera.timing, math::Random(scene.seed, "camera")),
      delay_us_(std::lround(1e6 * scene.sensors.camera.timing.delay)),
      occlusions_(scene.occlusions),
      noise_(scene.seed, "depth"),
      scenery_(scene, arms),
      camera_(*scene.camera, kMostPoints),
      start_utime_(start_utime),
      has_shape_(scene.camera->has_shape),
      has_clouds_(scene.camera->cloud_stride > 0 && clouds != nullptr),
      cloud_channel_(scene.cloud_channel),
      clouds_(std::move(clouds)),
      publisher_(control, channel::kShapeObservation, session) {}

void CameraPublisher::collect(bool wait) {
  if (auto shape = camera_.collect(wait))
    channel_.put(drawn_us_, {channel_.stamp(drawn_us_), std::move(*shape)});
}

void CameraPublisher::publish(const Reading& reading, std::int64_t now_us) {
  const std::int64_t utime = start_utime_ + reading.time_us;
  if (has_clouds_)
    clouds_(cloud_channel_, camera::encode_point_cloud(reading.shape.cloud_C, kCloudFrame, utime),
            start_utime_ + now_us);
  if (!has_shape_) return;
  auto message = make_observation(reading.shape.points_W, reading.shape.deviation);
  publisher_.publish(message, utime);
}

void CameraPublisher::step(std::int64_t now_us, const std::vector<Arm>& arms,
                           const object::Plant& plant) {
  if (channel_.due(now_us)) {
    ++pictures_;
    collect(!may_lag_);
    if (is_occluded(occlusions_, now_us)) {
      // Marks an omitted image.
    } else if (camera_.busy()) {
      ++left_out_;
    } else {
      // The noise of an image depends only on its index, not on which images were omitted before.
      camera_.submit(scenery_.now(arms, plant), noise_.split(std::to_string(pictures_)));
      drawn_us_ = now_us;
    }
  }
  // No reading arrives before its delay has passed: waiting is needed only then.
  collect(!may_lag_ && now_us >= drawn_us_ + delay_us_);
  Reading reading;
  while (channel_.take(now_us, reading)) publish(reading, now_us);
}

}  // namespace palpate::scenes
