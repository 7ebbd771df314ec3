#include "sim/scenes/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rt/config/key_file.hpp"
#include "rt/config/material_file.hpp"
#include "sim/scenes/camera_settings.hpp"

namespace palpate::scenes {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSmallest = 1e-6;

object::Box read_box(const config::Node& node) {
  return {node.vector3("lower"), node.vector3("upper")};
}

void read_bus(const config::Node& node, BusUrls& bus) {
  bus.control = node.text("control", bus.control);
  bus.housekeeping = node.text("housekeeping", bus.housekeeping);
  bus.pictures = node.text("pictures", bus.pictures);
}

/// Both hands have the same pads.
object::GraspOptions read_grasp(const config::Node& node, const char* box) {
  object::GraspOptions grasp;
  grasp.patch = read_box(node.child(box));
  const config::Node pads = node.child_or_empty("pads");
  grasp.stiffness = pads.number("stiffness", {1, 1e7}, grasp.stiffness);
  grasp.damping = pads.number("damping", {0, 1e4}, grasp.damping);
  grasp.friction = pads.number("friction", {0, 10}, grasp.friction);
  if (pads.has("grip")) grasp.grip = pads.number("grip", {0, 1e4});
  if (pads.has("pinch_axis")) {
    const std::string axis = pads.choice("pinch_axis", {"x", "y", "z"});
    grasp.pinch_axis = axis[0] - 'x';
  }
  return grasp;
}

/// What palpate-fit has found, as far as the plant can be made of it: Young's modulus and Poisson's
/// ratio of small strain, one Maxwell branch, and damping, whose part by stiffness becomes the
/// viscosity that is as strong in shear.
void take_fitted(const config::Node& object, const config::Node& material,
                 const config::MaterialFile& file, object::PlantOptions& plant) {
  const std::string model = file.model();
  if (model != "linear" && model != "neo_hookean")
    object.fail("material_file",
                "its model is " + model +
                    ", but the simulator's object is neo_hookean; allowed: linear, "
                    "neo_hookean: fit the recordings with one of them");
  const double E = config::material_number(material, file.constants(), "young_modulus", {1, 1e9});
  const double nu = config::material_number(material, file.constants(), "poisson_ratio", {0, 0.49});
  plant.mass_damping = file.constant("mass_damping", {0, 1e4}, plant.mass_damping);
  plant.viscosity = (file.constant("stiffness_damping", {0, 10}, 0) * E +
                     file.constant("viscosity", {0, 1e9}, 0)) /
                    (2 * (1 + nu));
  if (file.constants().has("relaxation_ratio"))
    plant.maxwell.push_back({file.constant("relaxation_ratio", {1e-6, 1e3}, 0),
                             file.constant("relaxation_time", {1e-6, 1e6}, 0)});
}

/// Section `material`, and what `material_file` puts over it.
void read_material(const config::Node& object, object::PlantOptions& plant) {
  const config::Node material = config::material_section(object);
  const auto file = config::MaterialFile::read(object);
  std::optional<config::Node> fitted;
  if (file) {
    take_fitted(object, material, *file, plant);
    fitted = file->constants();
  }
  plant.young_modulus = config::material_number(material, fitted, "young_modulus", {1, 1e9});
  plant.poisson_ratio = config::material_number(material, fitted, "poisson_ratio", {0, 0.49});
  plant.density = config::material_number(material, fitted, "density", {1, 2e4});
  for (const config::Node& item : material.list("maxwell")) {
    plant.maxwell.push_back({item.number("relative_modulus", {1e-6, 1e3}),
                             item.number("relaxation_time", {1e-6, 1e6})});
  }
  if (material.has("yield")) {
    const config::Node yield = material.child("yield");
    plant.yield =
        object::Yield{yield.number("stress", {1, 1e9}), yield.number("hardening", {0, 1e9}, 0)};
  }
  if (material.has("regions")) {
    for (const config::Node& item : material.list("regions")) {
      plant.regions.push_back(
          {read_box(item.child("box")), item.number("young_modulus", {1, 1e9})});
    }
  }
}

/// Stiffnesses are those of DART's springs, not of a material.
robot::SoftBoxOptions read_soft_box(const config::Node& node) {
  robot::SoftBoxOptions box;
  box.size = node.vector3("size", {kSmallest, 100});
  const std::vector<double> vertices = node.numbers("vertices", 3, {3, 200});
  for (int i = 0; i < 3; ++i) {
    if (vertices[i] != std::floor(vertices[i])) node.fail("vertices", "must be whole numbers");
    box.vertices[i] = static_cast<int>(vertices[i]);
  }
  const config::Node material = node.child("material");
  box.mass = material.number("density", {1, 2e4}) * box.size.prod();
  box.vertex_stiffness = material.number("vertex_stiffness", {1e-3, 1e6});
  box.edge_stiffness = material.number("edge_stiffness", {0, 1e6});
  box.damping = node.number("damping", {0, 1e3}, box.damping);
  box.friction = node.number("friction", {0, 10}, box.friction);
  box.on_floor = false;
  return box;
}

void read_object(const config::Node& node, Scene& scene) {
  object::PlantOptions& plant = scene.plant;
  plant.size = node.vector3("size", {kSmallest, 100});
  if (node.choice("kind", {"hyperelastic", "dart_soft"}, "hyperelastic") == "dart_soft") {
    scene.soft_box = read_soft_box(node);
    scene.X_WO = node.pose("pose");
    scene.object_gravity = node.flag("gravity", true);
    return;
  }
  const std::vector<double> elements = node.numbers("elements", 3, {1, 200});
  for (int i = 0; i < 3; ++i) {
    if (elements[i] != std::floor(elements[i])) node.fail("elements", "must be whole numbers");
    plant.elements[i] = static_cast<int>(elements[i]);
  }
  plant.grading = node.number("grading", {1, 3}, plant.grading);
  read_material(node, plant);
  plant.mass_damping = node.number("damping", {0, 1e4}, plant.mass_damping);
  plant.viscosity = node.number("viscosity", {0, 1e6}, plant.viscosity);
  scene.X_WO = node.pose("pose");
  if (node.has("grasp_box")) plant.grasps = {read_grasp(node, "grasp_box")};
  if (node.has("second_grasp_box")) {
    if (plant.grasps.empty()) node.fail("second_grasp_box", "needs a grasp_box as well");
    plant.grasps.push_back(read_grasp(node, "second_grasp_box"));
  }
  // An object that two hands hold needs no rig.
  if (node.has("clamp_box") || plant.grasps.size() < 2)
    plant.clamp = read_box(node.child("clamp_box"));
  scene.object_gravity = node.flag("gravity", true);
}

void read_robot(const config::Node& node, ArmScene& arm) {
  arm.urdf = node.path("urdf");
  const std::vector<double> joints = node.numbers("initial_joints", -1, {-2 * kPi, 2 * kPi});
  arm.initial_joints = Eigen::Map<const Eigen::VectorXd>(joints.data(), joints.size());
  arm.X_EG = node.pose("grasp_in_flange");
  const config::Node hand = node.child_or_empty("initial_hand");
  for (const std::string& joint : hand.keys())
    arm.initial_hand[joint] = hand.number(joint, {-2 * kPi, 2 * kPi});
  const config::Node frames = node.child_or_empty("frames");
  robot::FrameNames& names = arm.robot.frames;
  names.flange = frames.text("flange", names.flange);
  names.sensor = frames.text("sensor", names.sensor);
  names.imu = frames.text("imu", names.imu);
}

std::vector<Fingertip> read_fingertips(const config::Node& node) {
  std::vector<Fingertip> tips;
  for (const config::Node& item : node.list("fingertips")) {
    Fingertip tip;
    tip.link = item.text("link");
    tip.X_LT = item.pose("frame");
    object::FingertipOptions& sphere = tip.sphere;
    sphere.radius = item.number("radius", {1e-3, 0.1}, sphere.radius);
    sphere.friction = item.number("friction", {0, 10}, sphere.friction);
    if (item.has("stiffness")) sphere.stiffness = item.number("stiffness", {1e3, 1e12});
    tips.push_back(tip);
  }
  return tips;
}

std::vector<HandAction> read_hand(const config::Node& node) {
  std::vector<HandAction> actions;
  for (const config::Node& item : node.list("hand")) {
    HandAction action;
    action.at = item.number("at", {actions.empty() ? 0 : actions.back().at, 1e5});
    const std::string what = item.choice("action", {"open", "close", "hold"});
    if (what == "open") action.command.action = hand_command_t::OPEN;
    if (what == "close") action.command.action = hand_command_t::CLOSE;
    if (what == "hold") {
      action.command.action = hand_command_t::HOLD;
      action.command.force = item.number("force", {1e-3, HandControl::kMostForce});
    }
    actions.push_back(action);
  }
  return actions;
}

/// Motion that no list of poses says: `duration` and `rise` (s), `seed`, `periods` (s, shortest and
/// longest of its waves), most of each axis of `translation` (m) and `rotation_deg`.
Wander read_wander(const config::Node& node) {
  WanderOptions options;
  options.duration = node.number("duration", {0.1, 3600});
  options.rise = node.number("rise", {0.05, 60}, options.rise);
  options.seed = node.integer("seed", {0, std::numeric_limits<int>::max()}, 1);
  const std::vector<double> periods = node.numbers("periods", 2, {0.1, 600});
  if (!(periods[0] <= periods[1])) node.fail("periods", "must be the shortest, then the longest");
  options.shortest = periods[0];
  options.longest = periods[1];
  options.translation = node.vector3("translation", {0, 10}, Eigen::Vector3d::Zero());
  options.rotation = kPi / 180 * node.vector3("rotation_deg", {0, 180}, Eigen::Vector3d::Zero());
  return Wander(options);
}

MotionPlan read_motion(const config::Node& node) {
  std::vector<Leg> legs;
  for (const config::Node& item : node.list("poses")) {
    Leg leg;
    item.text("name", "");
    leg.move = item.number("move", {0.01, 600});
    leg.hold = item.number("hold", {0, 3600});
    leg.translation = item.vector3("translation", {-10, 10}, Eigen::Vector3d::Zero());
    leg.rotation = kPi / 180 * item.vector3("rotation_deg", {-180, 180}, Eigen::Vector3d::Zero());
    legs.push_back(leg);
  }
  std::optional<Wander> wander;
  if (node.has("wander")) wander = read_wander(node.child("wander"));
  if (legs.empty() && !wander) node.fail("poses", "at least one pose is needed, or a wander");
  return MotionPlan(std::move(legs), node.number("start_delay", {0, 3600}, 1), wander);
}

/// The keys of `robot`, the pose of its base in that of the first arm, and what is its own of
/// motion and sensors.
ArmScene read_second_arm(const config::Node& node, const Scene& scene) {
  if (scene.plant.grasps.size() < 2)
    node.fail("", "needs object.second_grasp_box, which says where its hand holds the object");
  ArmScene arm;
  arm.key = scene.key;
  read_robot(node, arm);
  const math::Pose X_base = node.pose("base_in_first");
  arm.X_WO = X_base.inverse() * scene.X_WO;
  arm.robot.gravity_W = X_base.linear().transpose() * scene.robot.gravity_W;
  arm.sensors = node.has("sensors") ? sensors::read_sensors(node.child("sensors")) : scene.sensors;
  if (node.has("motion")) arm.motion = read_motion(node.child("motion"));
  return arm;
}

/// {at, box}: from `at` on what lies in the box at rest bears nearly nothing.
std::vector<Cut> read_cuts(const config::Node& node) {
  std::vector<Cut> cuts;
  for (const config::Node& item : node.list("cuts")) {
    const double before = cuts.empty() ? 0 : cuts.back().at;
    cuts.push_back({item.number("at", {before, 1e5}), read_box(item.child("box"))});
  }
  return cuts;
}

/// A tracker of markers at `rest_points`: `rate` (Hz), `delay` (s), `drop_out`, `noise` (m) and
/// `occlusions` as of a camera.
MarkerOptions read_markers(const config::Node& node, const Scene& scene) {
  constexpr std::size_t kMost = 256;
  const Eigen::Vector3d lower = scene.plant.origin, upper = lower + scene.plant.size;
  MarkerOptions markers;
  markers.rest_points = node.points("rest_points");
  if (markers.rest_points.empty() || markers.rest_points.size() > kMost)
    node.fail("rest_points", "has no or too many points; allowed: 1 to 256");
  for (const Eigen::Vector3d& p : markers.rest_points) {
    if ((p.array() < lower.array() - 1e-9).any() || (p.array() > upper.array() + 1e-9).any())
      node.fail("rest_points", "a point lies outside the object");
  }
  markers.timing.rate = node.number("rate", {0.1, 1000}, 30);
  markers.timing.delay = node.number("delay", {0, 10}, 0);
  markers.timing.drop_out = node.number("drop_out", {0, 1}, 0);
  markers.noise = node.number("noise", {0, 0.1}, 0);
  markers.occlusions = read_occlusions(node);
  return markers;
}

}  // namespace

Scene read_scene(const config::Node& node) {
  Scene scene;
  constexpr double kMostSeed = std::numeric_limits<int>::max();
  scene.seed = static_cast<std::uint64_t>(node.integer("seed", {0, kMostSeed}, 1));
  read_bus(node.child_or_empty("bus"), scene.bus);
  scene.key = config::read_key(node);
  read_object(node.child("object"), scene);
  scene.pokes = read_pokes(node, scene.plant.size);
  read_robot(node.child("robot"), scene);
  scene.fingertips = read_fingertips(node);
  for (const Fingertip& tip : scene.fingertips) scene.plant.fingertips.push_back(tip.sphere);
  scene.hand = read_hand(node);
  scene.sensors = sensors::read_sensors(node.child_or_empty("sensors"));
  if (node.has("camera")) {
    scene.camera = read_camera(node.child("camera"), scene);
    scene.occlusions = read_occlusions(node.child("camera"));
  }
  scene.cuts = read_cuts(node);
  if (!scene.cuts.empty() && scene.soft_box)
    node.fail("cuts", "go through hyperelastic objects alone");
  if (node.has("markers")) {
    if (scene.camera) node.fail("markers", "given beside camera; allowed: one of them");
    if (scene.soft_box) node.fail("markers", "stick to hyperelastic objects alone");
    scene.markers = read_markers(node.child("markers"), scene);
  }
  if (node.has("motion")) scene.motion = read_motion(node.child("motion"));
  if (node.has("second_arm")) {
    scene.second_arm = read_second_arm(node.child("second_arm"), scene);
  } else if (scene.plant.grasps.size() > 1) {
    node.child("object").fail("second_grasp_box", "needs a section second_arm, whose hand it is");
  }
  node.check_all_used();
  return scene;
}

}  // namespace palpate::scenes
