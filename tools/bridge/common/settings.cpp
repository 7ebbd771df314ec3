#include "settings.hpp"

#include "rt/bus/udpm_url.hpp"
#include "rt/registry/arm_model.hpp"

namespace palpate::bridge {

kinematics::SerialChain read_chain(const config::Node& robot) {
  const std::string urdf = robot.path({"urdf", "", "expanded URDF file of the arm"});
  const std::string flange = robot.text({"flange", "", "link of the URDF that is E"}, "flange");
  try {
    return registry::read_urdf(urdf, flange);
  } catch (const std::invalid_argument& error) {
    robot.fail("urdf", error.what());
  }
}

double read_stale(const config::Node& robot) {
  return 1e-3 * robot.number({"stale_ms", "ms", "without a state, until the arm counts as absent"},
                             {5, 50}, 50);
}

std::string read_url(const config::Node& bus, const config::Key& key,
                     const std::string& otherwise) {
  const std::string url = bus.text(key, otherwise);
  try {
    palpate::bus::parse_udpm_url(url);
  } catch (const std::invalid_argument& error) {
    bus.fail(key.name, error.what());
  }
  return url;
}

std::string read_control_url(const config::Node& bus) {
  return read_url(bus, {"control", "", "palpated's sensors, robot and commands"},
                  "udpm://239.255.76.67:7667?ttl=0");
}

driver::JointGuard::Options read_guard(const config::Node& root) {
  using Options = driver::JointGuard::Options;
  const auto table =
      config::OptionTable<Options>()
          .number("linear_speed", "m/s", "largest speed of the flange", {1e-4, 2},
                  &Options::linear_speed)
          .number("angular_speed", "rad/s", "largest angular speed of the flange", {1e-4, 6},
                  &Options::angular_speed)
          .number("speed_share", "",
                  "fraction of the joints' speed limits in the URDF that is used", {0.01, 1},
                  &Options::speed_share)
          .number("acceleration", "rad/s^2", "largest acceleration of every joint", {0.1, 20},
                  &Options::acceleration)
          .number("jerk", "rad/s^3", "largest jerk of every joint that speeds up; 0: not limited",
                  {0, 1e5}, &Options::jerk)
          .number("margin", "rad", "margin to both position limits of every joint", {0, 0.5},
                  &Options::margin);
  return root.child_or_empty({"guard", "", "limits of the arm's motion"}).read(table);
}

}  // namespace palpate::bridge
