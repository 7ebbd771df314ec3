#include "settings.hpp"

#include "iiwa.hpp"
#include "panda.hpp"
#include "rt/config/bus_keys.hpp"
#include "rt/config/key_file.hpp"
#include "tools/bridge/common/settings.hpp"

namespace palpate::drake_bridge {
namespace {

using config::Node;
using config::OptionTable;

Gripper::Options read_gripper(const Node& node) {
  using Options = Gripper::Options;
  Options options = node.read(
      OptionTable<Options>()
          .number("open", "m", "distance of the open fingers", {0, 1}, &Options::open)
          .number("closed", "m", "distance that closing fingers are sent to", {0, 1},
                  &Options::closed)
          .number("force", "N", "limit of the force while the fingers open or close", {0.1, 1000},
                  &Options::force)
          .number("most_force", "N", "largest force of a command to hold", {0.1, 1000},
                  &Options::most_force)
          .number("holding_force", "N", "reported force above which closing fingers hold something",
                  {0, 1000}, &Options::holding_force));
  options.status = node.text({"status", "", "channel of lcmt_schunk_wsg_status"}, options.status);
  options.command =
      node.text({"command", "", "channel of lcmt_schunk_wsg_command"}, options.command);
  return options;
}

ShapeView::Options read_shape(const Node& node) {
  ShapeView::Options options;
  options.X_WO = node.pose(
      {"object_in_base", "m", "X_WO, as frames.object_in_base of palpated's configuration"});
  options.color =
      node.numbers({"color", "", "red, green, blue and opacity"}, 4, {0, 1}, options.color);
  options.rate = node.number({"rate", "1/s", "of messages, at most"}, {0.1, 100}, options.rate);
  return options;
}

}  // namespace

Settings read_settings(const Node& root) {
  const Node robot = root.child({"robot", "", "the arm and its messages"});
  const std::string arm =
      robot.choice({"arm", "", "kind of the arm's driver: positions (iiwa) or velocities (panda)"},
                   {"iiwa", "panda"});
  const bool is_iiwa = arm == "iiwa";
  Settings settings(bridge::read_chain(robot));
  settings.kind = is_iiwa ? Settings::Kind::kIiwa : Settings::Kind::kPanda;
  const std::string prefix = is_iiwa ? "IIWA" : "PANDA";
  settings.status = robot.text({"status", "", "channel of the arm's states"}, prefix + "_STATUS");
  settings.command =
      robot.text({"command", "", "channel of the commands to the arm"}, prefix + "_COMMAND");
  settings.wrench = robot.text(
      {"wrench", "", "channel of lcmt_force_torque, for FT_WRENCH; empty: another program does"},
      "");
  settings.external_torque =
      robot.choice(
          {"torque", "",
           "tau of ROBOT_STATE: measured (joint_torque_measured, joint_torque) or external "
           "(joint_torque_external)"},
          {"measured", "external"}, "measured") == "external";
  settings.stale = bridge::read_stale(robot);
  if (is_iiwa)
    settings.follow =
        robot.number({"follow", "rad", "error of a joint at rest that counts as a stopped arm"},
                     {1e-3, 0.5}, settings.follow);

  const Node bus = root.child_or_empty({"bus", "", "LCM URLs"});
  settings.control = bridge::read_control_url(bus);
  settings.channels = config::read_channel_names(bus);
  settings.housekeeping = bridge::read_url(bus, {"housekeeping", "", "palpated's shape"},
                                           "udpm://239.255.76.68:7668?ttl=0");
  settings.drake = bridge::read_url(bus, {"drake", "", "Drake's messages"}, settings.control);
  settings.largest_message = config::read_largest_message(bus);
  settings.key = config::read_key(root);
  settings.guard = bridge::read_guard(root);
  if (root.has("gripper"))
    settings.gripper = read_gripper(root.child({"gripper", "", "a Schunk WSG; absent: none"}));
  if (root.has("shape"))
    settings.shape = read_shape(root.child({"shape", "", "the shape for meldis; absent: none"}));
  root.check_all_used();
  return settings;
}

std::unique_ptr<bridge::Protocol> Settings::make_protocol(bus::MessageBus& bus) const {
  if (kind == Kind::kPanda)
    return std::make_unique<Panda>(bus, chain.joint_count(), status, command, external_torque);
  return std::make_unique<Iiwa>(bus, chain, status, command, follow, external_torque);
}

}  // namespace palpate::drake_bridge
