// driver_template: a driver between palpate and an arm, to be copied. Replace SimulatedArm by your
// own class (arm.hpp specifies it); everything else stays. See docs/own_robot.md.

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <palpate/channels.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <thread>

#include "joint_guard.hpp"
#include "rt/bus/stamped_publisher.hpp"
#include "rt/config/command_line.hpp"
#include "rt/config/installation.hpp"
#include "rt/registry/arm_model.hpp"
#include "simulated_arm.hpp"

namespace {

namespace bus = palpate::bus;
namespace channel = palpate::channel;
namespace driver = palpate::driver;
using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC, as times of arrival
using palpate::kinematics::SerialChain;

constexpr std::chrono::milliseconds kPeriod(1);

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

/// ROBOT_STATE at 500 Hz and FT_WRENCH at 1 kHz.
class Telemetry {
 public:
  Telemetry(bus::MessageBus& control, const SerialChain& chain)
      : chain_(chain),
        states_(control, channel::kRobotState, session_),
        wrenches_(control, channel::kFtWrench, session_) {
    state_.joint_count = chain.joint_count();
  }

  void publish(const driver::ArmState& arm) {
    const std::int64_t utime = bus::wall_clock_us();
    if (arm.has_wrench) {
      palpate::ft_wrench_t reading{};
      Eigen::Map<palpate::math::Vector6d>(reading.wrench) << arm.wrench_S.force,
          arm.wrench_S.torque;
      wrenches_.publish(reading, utime);
    }
    if (++tick_ % 2 != 0) return;
    const int n = chain_.joint_count();
    chain_.evaluate(arm.q, pose_);
    Eigen::Map<Eigen::VectorXd>(state_.q, n) = arm.q;
    Eigen::Map<Eigen::VectorXd>(state_.dq, n) = arm.dq;
    Eigen::Map<Eigen::VectorXd>(state_.tau, n) = arm.tau;
    Eigen::Map<Eigen::Vector3d>(state_.position) = pose_.X_WE.translation();
    palpate::math::wxyz_from_rotation(pose_.X_WE.linear(), state_.quaternion);
    Eigen::Map<palpate::math::Vector6d>(state_.twist) = pose_.J_W_E * arm.dq;
    states_.publish(state_, utime);
  }

 private:
  SerialChain chain_;
  SerialChain::State pose_;
  palpate::robot_state_t state_{};
  const std::int64_t session_ = bus::random_session();
  bus::StampedPublisher<palpate::robot_state_t> states_;
  bus::StampedPublisher<palpate::ft_wrench_t> wrenches_;
  int tick_ = 0;
};

/// After an emergency stop the arm stays at rest until the daemon itself has commanded zero
/// (palpate-command stop, then start): releasing the button does not request motion.
class StopLatch {
 public:
  /// Whether the arm must rest. `rest_commands`: see CommandInput.
  bool holds(bool stopped, std::int64_t rest_commands) {
    if (stopped) {
      if (!held_) std::fprintf(stderr, "emergency stop: rests until palpated is stopped\n");
      held_ = true;
      before_ = rest_commands;
    } else if (held_ && rest_commands > before_) {
      std::fprintf(stderr, "palpated has stopped: may move again\n");
      held_ = false;
    }
    return held_;
  }

 private:
  bool held_ = false;
  std::int64_t before_ = 0;
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
  driver::JointGuard guard(chain, options.guard);
  StopLatch latch;

  const auto control = bus::make_lcm_bus(options.url);
  driver::CommandInput input(*control, chain.joint_count(), access);
  Telemetry telemetry(*control, chain);
  control->start_without_thread();

  const driver::Command rest;
  driver::ArmState state;
  driver::Joints still;
  still.setZero(chain.joint_count());
  for (auto next = Clock::now(); ended == 0;) {
    control->receive(0);
    const driver::Command& wanted =
        input.read(Clock::now().time_since_epoch() / std::chrono::nanoseconds(1));
    if (arm.read(state)) {
      const bool held = latch.holds(state.stopped, input.rest_commands());
      arm.command(guard.limit(held ? rest : wanted, state.q));
      telemetry.publish(state);
    } else {
      arm.command(still);
    }
    next += kPeriod;
    if (next < Clock::now()) next = Clock::now();  // late: missed cycles are not made up
    std::this_thread::sleep_until(next);
  }
  arm.command(still);
  simulated = nullptr;
  const driver::Counts counts = input.counts();
  std::printf("%lld obeyed, %lld unauthorised, %lld rejected, %lld stops by the watchdog\n",
              static_cast<long long>(counts.obeyed), static_cast<long long>(counts.unauthorised),
              static_cast<long long>(counts.rejected), static_cast<long long>(counts.silences));
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
