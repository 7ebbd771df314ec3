// palpate-ur: palpated's robot is an arm of Universal Robots. See --help.

#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>

#include "ft300.hpp"
#include "rt/config/installation.hpp"
#include "settings.hpp"
#include "tools/bridge/common/program.hpp"

namespace {

namespace bridge = palpate::bridge;
namespace bus = palpate::bus;
namespace ur = palpate::ur_bridge;

std::string read_script() {
  const auto path = palpate::config::data_folder() / "tools/bridge/ur/follow_velocities.script";
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) throw std::runtime_error(path.string() + ": cannot be read");
  return text.str();
}

void run(const palpate::config::Node& configuration, const std::string& file) {
  ur::Settings settings = ur::read_settings(configuration);
  const bus::Access access{settings.key, bus::wall_clock_us()};
  const auto control = bus::make_lcm_bus(settings.control);
  control->set_channel_names(settings.channels);
  const bridge::BridgedArm::Options options = bridge::machine_options(settings.arm.stale);

  settings.arm.script = read_script();
  settings.arm.now_ns = options.now_ns;
  // Another than of a program that an earlier palpate-ur has left on the controller.
  settings.arm.numbers.run = static_cast<std::int32_t>(std::random_device()() >> 2);
  auto protocol = std::make_unique<ur::Ur>(
      bridge::make_tcp_stream(settings.host, settings.rtde_port),
      bridge::make_tcp_stream(settings.host, settings.script_port), settings.arm);
  const ur::Ur& arm_protocol = *protocol;
  std::optional<ur::Ft300> sensor;
  if (settings.ft300)
    sensor.emplace(bridge::make_tcp_stream(settings.host, settings.ft300->port),
                   settings.ft300->polarity, options.now_ns);
  bridge::WrenchInput* wrenches = nullptr;
  if (sensor)
    wrenches = &*sensor;
  else if (settings.arm.wrench)
    wrenches = protocol.get();
  bridge::BridgedArm arm(ur::Ur::kJoints, std::move(protocol), options, wrenches);
  palpate::driver::Driver cell(*control, settings.chain, settings.guard, access, arm);

  std::printf("%s: waits for the controller %s\n", file.c_str(), settings.host.c_str());
  std::fflush(stdout);
  bridge::run(cell, *control, arm);
  std::printf("%lld late states, %lld programs sent\n", static_cast<long long>(arm_protocol.late()),
              static_cast<long long>(arm_protocol.programs()));
  if (sensor)
    std::printf("%lld readings of the FT 300, %lld malformed\n",
                static_cast<long long>(sensor->readings()),
                static_cast<long long>(sensor->malformed()));
}

}  // namespace

int main(int argc, char** argv) {
  return bridge::bridge_main(
      "palpate-ur connects palpated with an arm of Universal Robots: states by RTDE, joint\n"
      "velocities to a program on the controller that stops by itself, a Robotiq FT 300 or the\n"
      "controller's own wrench. See docs/robots/ur.md.",
      "palpate-ur --config ur.yaml --set robot.host=192.168.1.10", argc, argv, run);
}
