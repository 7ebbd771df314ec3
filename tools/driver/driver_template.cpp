// driver_template: a driver between palpate and an arm, to be copied. Replace SimulatedArm by your
// own class (arm.hpp specifies it); everything else stays. See docs/own_robot.md.

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

#include "driver.hpp"
#include "rt/config/command_line.hpp"
#include "rt/config/installation.hpp"
#include "rt/registry/arm_model.hpp"
#include "simulated_arm.hpp"

namespace {

namespace bus = palpate::bus;
namespace driver = palpate::driver;
using palpate::kinematics::SerialChain;

struct Options {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  std::string key_file;
  std::string urdf;
  std::string flange = "flange";
  driver::JointGuard::Options guard;
  driver::SimulatedArm::Options arm;
  // Initial pose in which the simulated arm holds the bar of rt/config/examples/bar_long_soft.yaml.
  std::vector<double> joints = {0.850909334647,   -1.5784872221,  -1.57624131756, 1.73160305961,
                                0.00126629161428, 0.880668603759, 1.57936265436};
};

volatile std::sig_atomic_t ended = 0;
driver::SimulatedArm* simulated = nullptr;  // for the signals that emulate its stop button

int run(Options options) {
  bus::Access access;
  access.start_us = bus::wall_clock_us();  // commands sent before now are rejected
  if (!options.key_file.empty()) access.key = bus::read_key_file(options.key_file);
  if (options.urdf.empty())
    options.urdf = (palpate::config::data_folder() / "sim/robot/lwr_hand.urdf").string();
  const SerialChain chain = palpate::registry::read_urdf(options.urdf, options.flange);
  if (chain.joint_count() != static_cast<int>(options.joints.size()))
    throw std::invalid_argument("--joints: has " + std::to_string(options.joints.size()) +
                                " numbers; allowed: " + std::to_string(chain.joint_count()));
  options.arm.q = Eigen::Map<const Eigen::VectorXd>(options.joints.data(), chain.joint_count());

  driver::SimulatedArm arm(chain, options.arm);  // your class
  simulated = &arm;
  const auto control = bus::make_lcm_bus(options.url);
  driver::Driver cell(*control, chain, options.guard, access, arm);
  driver::run(cell, *control, ended);
  simulated = nullptr;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "driver_template moves a simulated arm as palpated commands: a driver to copy.\n"
      "SIGUSR1 presses the emergency stop of the simulated arm, SIGUSR2 releases it.");
  Options options;
  palpate::config::add_url_option(app, {{"control", &options.url}});
  app.add_option("--key", options.key_file, "file of the key that the daemon has");
  app.add_option("--urdf", options.urdf, "expanded URDF of the arm (default: palpate's own)");
  app.add_option("--flange", options.flange, "link of it that is E")->capture_default_str();
  app.add_option("--joints", options.joints, "of the simulated arm at first, rad");
  app.add_option("--linear-limit", options.guard.linear_speed, "m/s")->check(CLI::Range(0.0, 2.0));
  app.add_option("--angular-limit", options.guard.angular_speed, "rad/s")
      ->check(CLI::Range(0.0, 6.0));
  app.add_option("--speed-share", options.guard.speed_share, "of the joints' largest speeds")
      ->check(CLI::Range(0.01, 1.0));
  app.add_option("--mass", options.arm.mass, "kg, of the hand")->check(CLI::Range(0.0, 50.0));
  app.footer("Example:\n  driver_template --key robot.key --linear-limit 0.1");
  if (const auto code = palpate::config::parse(app, argc, argv, {{{0, "ended by a signal"}}}))
    return *code;
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { ended = 1; });
  std::signal(SIGUSR1, [](int) {
    if (simulated != nullptr) simulated->press_stop(true);
  });
  std::signal(SIGUSR2, [](int) {
    if (simulated != nullptr) simulated->press_stop(false);
  });
  try {
    return run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
