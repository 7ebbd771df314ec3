#include "sim/scenes/scene.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/constants.hpp"
#include "rt/config/bus_keys.hpp"
#include "rt/config/key_file.hpp"
#include "sim/scenes/camera_publisher.hpp"
#include "sim/scenes/obstacles.hpp"
#include "sim/scenes/scene_object.hpp"

namespace palpate::scenes {
namespace {

using math::kPi;

void read_bus(const config::Node& node, BusUrls& bus) {
  bus.control = node.text({"control", "", "sensors, robot and commands"}, bus.control);
  bus.housekeeping = node.text({"housekeeping", "", "truth"}, bus.housekeeping);
  bus.pictures = node.text({"pictures", "", "rendered images"}, bus.pictures);
  bus.clouds = node.text({"clouds", "", "clouds of a depth camera"}, bus.clouds);
  bus.channels = config::read_channel_names(node);
}

/// Refuses an inertia that no body of positive density has.
robot::Load read_load(const config::Node& node) {
  robot::Load load;
  load.mass = node.number({"mass", "kg", "of the body"}, {1e-3, 50});
  load.center_of_mass =
      node.vector3({"center_of_mass", "m", "in the link `sensor`"}, {-1, 1}, load.center_of_mass);
  const std::vector<double> inertia = node.numbers(
      {"inertia", "kg m^2", "xx, xy, xz, yy, yz, zz about the centre of mass, axes of S"}, 6,
      {-10, 10});
  std::copy(inertia.begin(), inertia.end(), load.inertia.data());
  const math::Vector6d& i = load.inertia;
  Eigen::Matrix3d moment;
  moment << i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5];
  const Eigen::Vector3d principal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moment, Eigen::EigenvaluesOnly).eigenvalues();
  if (principal[0] <= 0 || principal[2] > 1.0001 * (principal[0] + principal[1]))
    node.fail("inertia",
              "has principal moments that no body has; allowed: all above 0, none above "
              "the sum of the others");
  return load;
}

void read_robot(const config::Node& node, ArmScene& arm) {
  arm.urdf = node.path({"urdf", "", "of arm and hand, expanded"});
  const std::vector<double> joints = node.numbers(
      {"initial_joints", "rad", "of the arm, from the base on"}, -1, {-2 * kPi, 2 * kPi});
  arm.initial_joints = Eigen::Map<const Eigen::VectorXd>(joints.data(), joints.size());
  arm.X_EG = node.pose({"grasp_in_flange", "m", "X_EG"});
  const config::Node hand =
      node.child_or_empty({"initial_hand", "", "positions of joints of the hand"});
  for (const std::string& joint : hand.keys())
    arm.initial_hand[joint] = hand.number(
        config::Key::named_by_user(joint, "JOINT", "rad", "position of this joint of the hand"),
        {-2 * kPi, 2 * kPi});
  const config::Node frames = node.child_or_empty({"frames", "", "links of the URDF"});
  robot::FrameNames& names = arm.robot.frames;
  names.flange = frames.text({"flange", "", "link that is E"}, names.flange);
  names.sensor = frames.text({"sensor", "", "link that is S"}, names.sensor);
  names.imu = frames.text({"imu", "", "link that is I"}, names.imu);
  arm.robot.hand_mass_factor = node.number(
      {"hand_mass_factor", "", "on mass and inertia of all links beyond S"}, {0.05, 20}, 1);
  if (node.has("load"))
    arm.robot.load =
        read_load(node.child({"load", "", "rigid body beyond S, in addition to the URDF's links"}));
}

std::vector<Fingertip> read_fingertips(const config::Node& node) {
  std::vector<Fingertip> tips;
  for (const config::Node& item : node.list({"fingertips", "", "spheres that touch the object"})) {
    Fingertip tip;
    tip.link = item.text({"link", "", "of the URDF that carries it"});
    tip.X_LT = item.pose({"frame", "m", "X of T in that link"});
    object::FingertipOptions& sphere = tip.sphere;
    sphere.radius = item.number({"radius", "m", "of the sphere"}, {1e-3, 0.1}, sphere.radius);
    sphere.friction = item.number({"friction", "", "of Coulomb"}, {0, 10}, sphere.friction);
    if (item.has("stiffness"))
      sphere.stiffness = item.number(
          {"stiffness", "N/m^3", "pressure by penetration; absent: 50 E / radius"}, {1e3, 1e12});
    tips.push_back(tip);
  }
  return tips;
}

std::vector<HandAction> read_hand(const config::Node& node) {
  std::vector<HandAction> actions;
  for (const config::Node& item :
       node.list({"hand", "", "what the hand does, in the order of time"})) {
    HandAction action;
    action.at =
        item.number({"at", "s", "simulated time"}, {actions.empty() ? 0 : actions.back().at, 1e5});
    const std::string what = item.choice({"action", "", "what it does"}, {"open", "close", "hold"});
    if (what == "open") action.command.action = hand_command_t::OPEN;
    if (what == "close") action.command.action = hand_command_t::CLOSE;
    if (what == "hold") {
      action.command.action = hand_command_t::HOLD;
      action.command.force =
          item.number({"force", "N", "of hold"}, {1e-3, HandControl::kMostForce});
    }
    actions.push_back(action);
  }
  return actions;
}

/// Random motion without a list of poses: `duration` and `rise` (s), `seed`, `periods` (s, shortest
/// and longest of its sine waves), largest amplitude per axis of `translation` (m) and
/// `rotation_deg`.
Wander read_wander(const config::Node& node) {
  WanderOptions options;
  options.duration = node.number({"duration", "s", "of the motion"}, {0.1, 3600});
  options.rise = node.number({"rise", "s", "until it has its full size"}, {0.05, 60}, options.rise);
  options.seed =
      node.integer({"seed", "", "of the motion"}, {0, std::numeric_limits<int>::max()}, 1);
  const std::vector<double> periods =
      node.numbers({"periods", "s", "shortest and longest of its waves"}, 2, {0.1, 600});
  if (!(periods[0] <= periods[1])) node.fail("periods", "must be the shortest, then the longest");
  options.shortest = periods[0];
  options.longest = periods[1];
  options.translation = node.vector3({"translation", "m", "most along each axis of O"}, {0, 10},
                                     Eigen::Vector3d::Zero());
  options.rotation = kPi / 180 *
                     node.vector3({"rotation_deg", "degrees", "most about each axis of O"},
                                  {0, 180}, Eigen::Vector3d::Zero());
  return Wander(options);
}

MotionPlan read_motion(const config::Node& node) {
  std::vector<Leg> legs;
  for (const config::Node& item : node.list({"poses", "", "of the hand, one after the other"})) {
    Leg leg;
    item.text({"name", "", "of the pose, in reports"}, "");
    leg.move = item.number({"move", "s", "that the hand takes to get there"}, {0.01, 600});
    leg.hold = item.number({"hold", "s", "that it stays"}, {0, 3600});
    leg.translation = item.vector3({"translation", "m", "of the grasp from where it began, in O"},
                                   {-10, 10}, Eigen::Vector3d::Zero());
    leg.rotation = kPi / 180 *
                   item.vector3({"rotation_deg", "degrees", "rotation vector of it, in O"},
                                {-180, 180}, Eigen::Vector3d::Zero());
    legs.push_back(leg);
  }
  std::optional<Wander> wander;
  if (node.has("wander"))
    wander = read_wander(node.child({"wander", "", "motion that no list of poses says"}));
  if (legs.empty() && !wander) node.fail("poses", "at least one pose is needed, or a wander");
  return MotionPlan(std::move(legs),
                    node.number({"start_delay", "s", "before the first pose"}, {0, 3600}, 1),
                    wander);
}

/// The keys of `robot`, the pose of its base relative to that of the first arm, and its own motion
/// and sensors.
ArmScene read_second_arm(const config::Node& node, const Scene& scene) {
  if (scene.plant.grasps.size() < 2)
    node.fail("", "needs object.second_grasp_box, which says where its hand holds the object");
  ArmScene arm;
  arm.key = scene.key;
  read_robot(node, arm);
  const math::Pose X_base = node.pose({"base_in_first", "m", "its base in that of the first arm"});
  arm.X_WO = X_base.inverse() * scene.X_WO;
  arm.robot.gravity_W = X_base.linear().transpose() * scene.robot.gravity_W;
  arm.sensors = node.has("sensors")
                    ? sensors::read_sensors(node.child(
                          {"sensors", "",
                           "errors of the sensors, over those of sim/sensors/sensors.yaml; of a "
                           "second arm by default those of the first"}))
                    : scene.sensors;
  if (node.has("motion"))
    arm.motion = read_motion(
        node.child({"motion", "", "prescribed motion of the hand; absent: it obeys commands"}));
  return arm;
}

/// {at, box}: from `at` on the material within the box at rest has nearly no stiffness.
std::vector<Cut> read_cuts(const config::Node& node) {
  std::vector<Cut> cuts;
  for (const config::Node& item :
       node.list({"cuts", "", "knife: from a moment on a part bears nearly nothing"})) {
    const double before = cuts.empty() ? 0 : cuts.back().at;
    cuts.push_back({item.number({"at", "s", "moment of the cut"}, {before, 1e5}),
                    read_box(item.child({"box", "", "what is cut, at rest, in O"}))});
  }
  return cuts;
}

/// A tracker of markers at `rest_points`: `rate` (Hz), `delay` (s), `drop_out`, `noise` (m) and
/// `occlusions` as for a camera.
MarkerOptions read_markers(const config::Node& node, const Scene& scene) {
  constexpr std::size_t kMost = 256;
  const Eigen::Vector3d lower = scene.plant.origin, upper = lower + scene.plant.size;
  MarkerOptions markers;
  markers.rest_points = node.points({"rest_points", "m", "places of markers at rest, in O"});
  if (markers.rest_points.empty() || markers.rest_points.size() > kMost)
    node.fail("rest_points", "has no or too many points; allowed: 1 to 256");
  for (const Eigen::Vector3d& p : markers.rest_points) {
    if ((p.array() < lower.array() - 1e-9).any() || (p.array() > upper.array() + 1e-9).any())
      node.fail("rest_points", "a point lies outside the object");
  }
  markers.timing.rate = node.number({"rate", "Hz", "of messages"}, {0.1, 1000}, 30);
  markers.timing.delay = node.number({"delay", "s", "of messages"}, {0, 10}, 0);
  markers.timing.drop_out =
      node.number({"drop_out", "", "share of markers that are missed"}, {0, 1}, 0);
  markers.noise = node.number({"noise", "m", "standard deviation of a coordinate"}, {0, 0.1}, 0);
  markers.occlusions = read_occlusions(node);
  return markers;
}

}  // namespace

Scene read_scene(const config::Node& node) {
  Scene scene;
  constexpr double kMostSeed = std::numeric_limits<int>::max();
  scene.seed = static_cast<std::uint64_t>(
      node.integer({"seed", "", "of all random numbers"}, {0, kMostSeed}, 1));
  read_bus(node.child_or_empty({"bus", "", "LCM URLs"}), scene.bus);
  scene.key = config::read_key(node);
  read_object(node.child({"object", "", "the soft object"}), scene);
  read_robot(node.child({"robot", "", "arm and hand"}), scene);
  scene.pokes =
      read_pokes(node, scene.plant.size, scene.X_WO.linear().transpose() * scene.robot.gravity_W);
  scene.slips = read_slips(node, static_cast<int>(scene.plant.grasps.size()));
  scene.plant.obstacles = read_obstacles(node);
  if (!scene.plant.obstacles.empty() && scene.soft_box)
    node.fail("obstacles", "touch hyperelastic objects alone");
  scene.fingertips = read_fingertips(node);
  for (const Fingertip& tip : scene.fingertips) scene.plant.fingertips.push_back(tip.sphere);
  scene.hand = read_hand(node);
  scene.sensors = sensors::read_sensors(
      node.child_or_empty({"sensors", "", "errors of its own; absent: those of the first"}));
  if (node.has("camera")) {
    const config::Node camera =
        node.child({"camera", "", "depth camera that publishes clouds; absent: none"});
    scene.camera = read_camera(camera, scene);
    scene.cloud_channel = read_cloud_channel(camera);
    scene.occlusions = read_occlusions(camera);
  }
  scene.cuts = read_cuts(node);
  if (!scene.cuts.empty() && scene.soft_box)
    node.fail("cuts", "go through hyperelastic objects alone");
  if (node.has("markers")) {
    if (scene.camera) node.fail("markers", "given together with camera; allowed: one of them");
    if (scene.soft_box) node.fail("markers", "stick to hyperelastic objects alone");
    scene.markers = read_markers(
        node.child({"markers", "", "points that a tracker publishes in SHAPE_OBSERVATION"}), scene);
  }
  if (node.has("motion"))
    scene.motion = read_motion(
        node.child({"motion", "", "prescribed motion of the hand; absent: it obeys commands"}));
  if (node.has("second_arm")) {
    scene.second_arm = read_second_arm(
        node.child({"second_arm", "", "an arm that holds the object as well"}), scene);
  } else if (scene.plant.grasps.size() > 1) {
    node.child("object").fail("second_grasp_box", "needs a section second_arm, whose hand it is");
  }
  node.check_all_used();
  return scene;
}

}  // namespace palpate::scenes
