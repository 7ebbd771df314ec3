#include "settings.hpp"

#include <regex>

#include "rt/config/bus_keys.hpp"
#include "rt/config/key_file.hpp"
#include "tools/bridge/common/settings.hpp"

namespace palpate::ros2_bridge {
namespace {

using config::Key;
using config::Node;

/// A name of ROS 2 without the slash in front.
std::string checked_topic(const Node& node, const Key& key, std::string topic) {
  static const std::regex kName("/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*");
  if (!std::regex_match(topic, kName))
    node.fail(key.name, "is '" + topic + "'; allowed: names of letters, digits and _, joined by /");
  if (topic.front() == '/') topic.erase(0, 1);
  return topic;
}

std::string read_topic(const Node& node, const Key& key) {
  return checked_topic(node, key, node.text(key));
}

/// Empty: none.
std::string read_optional_topic(const Node& node, const Key& key) {
  const std::string topic = node.text(key, "");
  return topic.empty() ? topic : checked_topic(node, key, topic);
}

Participant::Options read_participant(const Node& ros) {
  Participant::Options options;
  options.domain = ros.integer({"domain", "", "ROS_DOMAIN_ID of the nodes"}, {0, 232}, 0);
  options.interface =
      ros.text({"interface", "", "network interface; empty: Cyclone DDS chooses"}, "");
  if (ros.has("peers"))
    options.peers = ros.texts({"peers", "", "hosts that multicast does not reach; absent: none"});
  return options;
}

Clock read_clock(const Node& ros) {
  Clock clock;
  clock.is_sender = ros.choice({"clock", "",
                                "time of a message: sender (its stamp, of the system time) or "
                                "received (simulated time, clocks that are not equal)"},
                               {"sender", "received"}, "sender") == "sender";
  clock.most_age = 1e-3 * ros.number({"most_age_ms", "ms",
                                      "of a stamp at its reception; older messages, and those as "
                                      "far in the future, are refused"},
                                     {1, 1000}, 1e3 * clock.most_age);
  return clock;
}

struct Frames {
  std::string base, sensor, object;
  math::Pose X_WO;
};

Frames read_frames(const Node& frames) {
  return {frames.text({"base", "", "name of W in headers"}, "base_link"),
          frames.text({"sensor", "", "name of S in headers"}, "ft_sensor"),
          frames.text({"object", "", "name of O in headers"}, "object"),
          frames.pose({"object_in_base", "m",
                       "X_WO, as frames.object_in_base of palpated's configuration"})};
}

Settings::Robot read_robot(const Node& root, const Clock& clock, const Frames& frames) {
  const Node robot = root.child({"robot", "", "an arm; absent: another program connects it"});
  Settings::Robot settings{bridge::read_chain(robot), bridge::read_stale(robot), {}, {}};
  JointStateArm::Options& arm = settings.arm;
  const Key states{"states", "", "topic of sensor_msgs/JointState"};
  arm.states = checked_topic(robot, states, robot.text(states, arm.states));
  arm.commands = read_topic(robot, {"commands", "", "topic of the commands"});
  arm.kind = robot.choice({"command", "",
                           "velocities (std_msgs/Float64MultiArray, rad/s) or twist "
                           "(geometry_msgs/TwistStamped of the flange in the base)"},
                          {"velocities", "twist"}, "velocities") == "twist"
                 ? JointStateArm::Commands::kTwist
                 : JointStateArm::Commands::kVelocities;
  if (robot.has("joints")) {
    arm.joints = robot.texts(
        {"joints", "", "names in the joint states, from the base; absent: those of the URDF"});
    if (static_cast<int>(arm.joints.size()) != settings.chain.joint_count())
      robot.fail("joints", "has " + std::to_string(arm.joints.size()) + " names; allowed: " +
                               std::to_string(settings.chain.joint_count()) + ", as the URDF");
  }
  arm.frame = frames.base;
  arm.clock = clock;
  settings.guard = bridge::read_guard(root);
  return settings;
}

void read_inputs(const Node& root, Settings& settings) {
  if (root.has("wrench")) {
    const Node node = root.child({"wrench", "", "a wrist sensor; absent: another program's"});
    Settings::Wrench wrench;
    wrench.topic = read_topic(node, {"topic", "", "of geometry_msgs/WrenchStamped"});
    wrench.polarity =
        node.integer({"polarity", "",
                      "1: it reports the wrench on the hand; -1: that of the surroundings on it"},
                     {-1, 1}, -1);
    if (wrench.polarity == 0) node.fail("polarity", "is 0; allowed: 1, -1");
    settings.wrench = wrench;
  }
  settings.imu =
      read_optional_topic(root, {"imu", "", "topic of sensor_msgs/Imu, for IMU; empty: none"});
  if (root.has("cloud")) {
    const Node node = root.child({"cloud", "", "a depth camera for palpate-see; absent: none"});
    CloudRelay::Options cloud;
    cloud.topic = read_topic(node, {"topic", "", "of sensor_msgs/PointCloud2"});
    cloud.channel = node.text({"channel", "", "of LCM, as palpate-see names it"}, cloud.channel);
    if (!bus::is_channel_name(cloud.channel))
      node.fail("channel", "is no name of a channel; allowed: letters A to Z, digits and _");
    cloud.clock = settings.clock;
    // A camera's driver may need longer than a sensor's for a cloud.
    cloud.clock.most_age =
        1e-3 * node.number({"most_age_ms", "ms", "as ros.most_age_ms, of clouds"}, {1, 10000}, 500);
    settings.cloud = cloud;
  }
}

void read_outputs(const Node& root, const Frames& frames, Settings& settings) {
  const Node node = root.child_or_empty({"outputs", "", "topics that it publishes; empty: none"});
  Telemetry::Options& telemetry = settings.telemetry;
  telemetry.wrench =
      read_optional_topic(node, {"wrench", "", "WRENCH_COMPENSATED as WrenchStamped in S"});
  telemetry.hand_pose =
      read_optional_topic(node, {"hand_pose", "", "ROBOT_STATE as PoseStamped in W"});
  telemetry.grasp_pose =
      read_optional_topic(node, {"grasp_pose", "", "ESTIMATE as PoseStamped in O"});
  settings.diagnostics = read_optional_topic(
      node, {"diagnostics", "", "HEALTH and COMPONENT_EVENT as DiagnosticArray"});
  telemetry.base = frames.base;
  telemetry.sensor = frames.sensor;
  telemetry.object = frames.object;
  if (root.has("shape")) {
    const Node shape = root.child({"shape", "", "the shape as a Marker; absent: none"});
    ShapeMarker::Options options;
    options.topic = read_topic(shape, {"topic", "", "of visualization_msgs/Marker"});
    options.color =
        shape.numbers({"color", "", "red, green, blue and opacity"}, 4, {0, 1}, options.color);
    options.rate = shape.number({"rate", "1/s", "of messages, at most"}, {0.1, 100}, options.rate);
    options.frame = frames.base;
    options.X_WO = frames.X_WO;
    settings.shape = options;
  }
}

void read_requests(const Node& root, const Frames& frames, Settings& settings) {
  const Node node =
      root.child_or_empty({"requests", "", "what nodes may ask of palpated; absent: nothing"});
  settings.services = read_optional_topic(
      node, {"services", "", "prefix of the services start, stop, reset, zero; empty: none"});
  settings.commands = read_optional_topic(
      node, {"commands", "", "topic of std_msgs/String with these words; empty: none"});
  TargetTopic::Options target;
  target.topic =
      read_optional_topic(node, {"target", "", "topic of the feature's targets; empty: none"});
  target.kind = node.choice({"target_kind", "", "point (PointStamped) or pose (PoseStamped)"},
                            {"point", "pose"}, "point");
  if (node.has("rest_points"))
    for (const Eigen::Vector3d& point :
         node.points({"rest_points", "m", "of the target, in O; absent: as palpated configures"}))
      target.rest_points.insert(target.rest_points.end(), point.begin(), point.end());
  target.base = frames.base;
  target.object = frames.object;
  target.X_WO = frames.X_WO;
  target.clock = settings.clock;
  if (!target.topic.empty()) settings.target = target;
}

}  // namespace

Settings read_settings(const Node& root) {
  Settings settings;
  const Node ros = root.child_or_empty({"ros", "", "the ROS 2 domain"});
  settings.participant = read_participant(ros);
  settings.clock = read_clock(ros);
  const Frames frames = read_frames(root.child_or_empty({"frames", "", "names and poses"}));
  if (root.has("robot")) settings.robot = read_robot(root, settings.clock, frames);
  read_inputs(root, settings);
  read_outputs(root, frames, settings);
  read_requests(root, frames, settings);

  const Node bus = root.child_or_empty({"bus", "", "LCM URLs"});
  settings.control = bridge::read_control_url(bus);
  settings.channels = config::read_channel_names(bus);
  settings.housekeeping =
      bridge::read_url(bus, {"housekeeping", "", "palpated's shape, health and events"},
                       "udpm://239.255.76.68:7668?ttl=0");
  const std::string clouds =
      bridge::read_url(bus, {"clouds", "", "clouds, for palpate-see"}, settings.control);
  if (settings.cloud) settings.cloud->url = clouds;
  settings.key = config::read_key(root);
  root.check_all_used();
  return settings;
}

}  // namespace palpate::ros2_bridge
