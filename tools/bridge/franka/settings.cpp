#include "settings.hpp"

#include "rt/config/bus_keys.hpp"
#include "rt/config/key_file.hpp"
#include "tools/bridge/common/settings.hpp"

namespace palpate::franka_bridge {
namespace {

using config::Node;

constexpr double kMostAcceleration = 8;  // rad/s^2, which the arm can follow

Franka::Torque read_torque(const Node& robot) {
  const std::string source = robot.choice({"torque", "",
                                           "tau of ROBOT_STATE: none, measured (tau_J, with "
                                           "gravity) or external (tau_ext_hat_filtered)"},
                                          {"none", "measured", "external"}, "measured");
  if (source == "none") return Franka::Torque::kNone;
  return source == "measured" ? Franka::Torque::kMeasured : Franka::Torque::kExternal;
}

Franka::ExternalWrench read_wrench(const Node& wrench) {
  const auto polarity = wrench.integer(
      {"polarity", "", "1: it reports the wrench on the hand; -1: that of the surroundings on it"},
      {-1, 1}, -1);
  if (polarity == 0) wrench.fail("polarity", "is 0; allowed: 1, -1");
  Franka::ExternalWrench reading;
  reading.polarity = polarity;
  reading.payload = wrench.number(
      {"payload", "kg", "end effector and load that are set in the arm, which subtracts them"},
      {0, 10});
  return reading;
}

}  // namespace

Settings read_settings(const Node& root) {
  const Node robot = root.child({"robot", "", "the arm and its control"});
  Settings settings(bridge::read_chain(robot));
  if (settings.chain.joint_count() != kJoints)
    robot.fail("urdf", "has " + std::to_string(settings.chain.joint_count()) +
                           " joints up to the flange; allowed: 7");
  settings.host = robot.text({"host", "", "name or address of the arm's control"});
  settings.port = robot.integer({"port", "", "TCP port of the FCI"}, {1, 65535}, settings.port);
  settings.fifo_priority =
      robot.integer({"fifo_priority", "", "SCHED_FIFO priority; 0: ordinary scheduling"}, {0, 98},
                    settings.fifo_priority);
  Franka::Options& arm = settings.arm;
  settings.stale = bridge::read_stale(robot);
  arm.torque = read_torque(robot);
  arm.recovers = robot.flag(
      {"recover", "", "whether the arm is asked to leave a reflex by itself, after 1 s"}, false);
  if (root.has("wrench"))
    arm.wrench =
        read_wrench(root.child({"wrench", "", "the arm's external wrench; absent: not published"}));

  const Node bus = root.child_or_empty({"bus", "", "LCM URLs"});
  settings.control = bridge::read_control_url(bus);
  settings.channels = config::read_channel_names(bus);
  settings.key = config::read_key(root);
  settings.guard = bridge::read_guard(root);
  if (settings.guard.acceleration > kMostAcceleration)
    root.child_or_empty({"guard", "", "limits of the arm's motion"})
        .fail("acceleration", "is more than the arm follows; allowed: up to 8");
  root.check_all_used();
  return settings;
}

}  // namespace palpate::franka_bridge
