#include "settings.hpp"

#include <algorithm>

#include "rt/config/bus_keys.hpp"
#include "rt/config/key_file.hpp"
#include "tools/bridge/common/settings.hpp"

namespace palpate::ur_bridge {
namespace {

using config::Node;

constexpr double kSpeedMargin = 0.01;  // rad/s, of rounding

void read_torque(const Node& robot, Ur::Options& arm) {
  const std::string source =
      robot.choice({"torque", "",
                    "tau of ROBOT_STATE: none, constants (times the joints' currents) or reported "
                    "(actual_current_as_torque)"},
                   {"none", "constants", "reported"}, "none");
  if (source == "reported") arm.torque = Ur::Torque::kReported;
  if (source != "constants") return;
  arm.torque = Ur::Torque::kConstants;
  const std::vector<double> constants =
      robot.numbers({"torque_constants", "N m/A", "torque of each joint by its current"},
                    Ur::kJoints, {0.1, 100});
  std::copy(constants.begin(), constants.end(), arm.torque_constants.begin());
}

void read_wrench(const Node& wrench, Settings& settings) {
  const std::string source = wrench.choice(
      {"source", "", "FT_WRENCH: ft300 or controller (actual_TCP_force)"}, {"ft300", "controller"});
  const auto polarity = wrench.integer(
      {"polarity", "", "1: it reports the wrench on the hand; -1: that of the hand"}, {-1, 1}, -1);
  if (polarity == 0) wrench.fail("polarity", "is 0; allowed: 1, -1");
  if (source == "ft300") {
    Settings::Ft300Port stream;
    stream.polarity = polarity;
    stream.port =
        wrench.integer({"port", "", "TCP port of the sensor's stream"}, {1, 65535}, stream.port);
    settings.ft300 = stream;
    return;
  }
  Ur::ControllerWrench reading;
  reading.polarity = polarity;
  reading.payload = wrench.number(
      {"payload", "kg", "payload that is set in the controller, which subtracts it"}, {0, 50});
  settings.arm.wrench = reading;
}

}  // namespace

Settings read_settings(const Node& root) {
  const Node robot = root.child({"robot", "", "the arm and its controller"});
  Settings settings(bridge::read_chain(robot));
  if (settings.chain.joint_count() != Ur::kJoints)
    robot.fail("urdf", "has " + std::to_string(settings.chain.joint_count()) +
                           " joints up to the flange; allowed: 6");
  settings.host = robot.text({"host", "", "name or address of the controller"});
  settings.rtde_port =
      robot.integer({"rtde_port", "", "TCP port of RTDE"}, {1, 65535}, settings.rtde_port);
  settings.script_port = robot.integer({"script_port", "", "TCP port that takes programs"},
                                       {1, 65535}, settings.script_port);
  Ur::Options& arm = settings.arm;
  const std::string rate =
      robot.choice({"rate", "1/s", "states: 125 (CB3 and later), 250 or 500 (e-Series and later)"},
                   {"125", "250", "500"}, "500");
  arm.rate = std::stod(rate);
  arm.stale = bridge::read_stale(robot);
  arm.numbers.first =
      robot.integer({"first_register", "", "first of the general purpose registers that are used"},
                    {0, 42}, arm.numbers.first);
  arm.numbers.acceleration = robot.number(
      {"deceleration", "rad/s^2", "of the joints when the controller's program stops them"},
      {1, 40}, arm.numbers.acceleration);
  arm.numbers.watchdog =
      1e-3 * robot.number({"watchdog_ms", "ms", "without a command, until that program stops"},
                          {10, 60}, 1e3 * arm.numbers.watchdog);
  read_torque(robot, arm);
  if (root.has("wrench"))
    read_wrench(root.child({"wrench", "", "a wrist sensor; absent: another program's"}), settings);

  const Node bus = root.child_or_empty({"bus", "", "LCM URLs"});
  settings.control = bridge::read_control_url(bus);
  settings.channels = config::read_channel_names(bus);
  settings.key = config::read_key(root);
  settings.guard = bridge::read_guard(root);
  if (arm.numbers.acceleration < settings.guard.acceleration)
    robot.fail("deceleration", "is less than guard.acceleration; allowed: at least that");
  arm.numbers.most_speed = 0;
  for (int i = 0; i < Ur::kJoints; ++i)
    arm.numbers.most_speed = std::max(arm.numbers.most_speed,
                                      settings.guard.speed_share * settings.chain.joint(i).speed);
  arm.numbers.most_speed += kSpeedMargin;
  root.check_all_used();
  return settings;
}

}  // namespace palpate::ur_bridge
