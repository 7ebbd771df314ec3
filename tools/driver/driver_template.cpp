// driver_template: what stands between palpate and an arm, to be copied. It moves an ideal flange,
// which is where it says and follows every command at once; put your arm in the place of IdealArm.
// What must stay is TwistInput: nobody steers the arm but the daemon that has the key, and the arm
// stands still where no good command has come for 100 ms.

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/robot_state_t.hpp>
#include <palpate/twist_command_t.hpp>
#include <random>
#include <thread>

#include "core/math/rigid.hpp"
#include "rt/bus/authentication.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace {

namespace bus = palpate::bus;
namespace math = palpate::math;
using palpate::ft_wrench_t;
using palpate::robot_state_t;
using palpate::twist_command_t;

constexpr double kPeriod = 1e-3;                // s
constexpr std::int64_t kSilence = 100'000'000;  // ns without a command, after which the arm stops
constexpr const char* kChannel = "TWIST_COMMAND";

struct Options {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  std::string key_file;
  double linear_limit = 0.25;  // m/s
  double angular_limit = 1;    // rad/s
  double mass = 4.8;           // kg, behind the force-torque sensor
  // X_WE at first: as in rt/config/examples/bar_long_soft.yaml, whose bar it holds.
  std::vector<double> position = {0.59, 0, 0.31};
};

struct Counts {
  std::int64_t obeyed = 0;
  std::int64_t refused = 0;   // without a valid code, or sent before
  std::int64_t rejected = 0;  // late, of another arm, or not numbers
  std::int64_t stops = 0;     // because commands had ceased to come
};

/// The twist that the daemon wants now, V_W_E.
class TwistInput {
 public:
  TwistInput(bus::MessageBus& control, const Options& options, const bus::Access& access)
      : options_(options), commands_(control, kChannel, 64), admission_(kChannel, access) {}

  math::Twist read(std::int64_t now_ns) {
    twist_command_t message;
    std::int64_t arrival_ns = 0;
    while (commands_.take(message, arrival_ns)) take(message, arrival_ns);
    if (moving_ && now_ns - good_ns_ > kSilence) {
      ++counts_.stops;
      stop();
    }
    return wanted_;
  }

  Counts counts() const {
    Counts counts = counts_;
    counts.refused = admission_.refused();
    return counts;
  }

 private:
  void take(const twist_command_t& message, std::int64_t arrival_ns) {
    // The code first: what is forged must not even touch the sequence.
    if (admission_.judge(message) != bus::Admitted::kFresh) return;
    const Eigen::Map<const math::Vector6d> twist(message.twist);
    if (!order_.accept(message.session, message.seq) || message.grasp != 0 || !twist.allFinite()) {
      ++counts_.rejected;
      return;
    }
    ++counts_.obeyed;
    good_ns_ = arrival_ns;
    if (message.valid != 1) return stop();
    wanted_ = math::Twist::from(twist);
    wanted_.linear = limited(wanted_.linear, options_.linear_limit);
    wanted_.angular = limited(wanted_.angular, options_.angular_limit);
    moving_ = true;
  }

  void stop() {
    wanted_ = {};
    moving_ = false;
  }

  /// Slower, but in the same direction.
  static Eigen::Vector3d limited(const Eigen::Vector3d& velocity, double limit) {
    const double speed = velocity.stableNorm();
    return speed > limit ? Eigen::Vector3d(limit / speed * velocity) : velocity;
  }

  const Options& options_;
  bus::TypedSubscription<twist_command_t> commands_;
  bus::Admission admission_;
  bus::SequenceTracker order_;
  math::Twist wanted_;
  bool moving_ = false;
  std::int64_t good_ns_ = 0;
  Counts counts_;
};

/// In the place of an arm: its flange alone, and a sensor that weighs a hand.
class IdealArm {
 public:
  explicit IdealArm(const Options& options) : weight_(9.81 * options.mass) {
    X_WE_.linear() = Eigen::Quaterniond(1, 0, 1, 0).normalized().toRotationMatrix();
    X_WE_.translation() = Eigen::Map<const Eigen::Vector3d>(options.position.data());
  }

  void command(const math::Twist& V_W_E) {
    V_W_E_ = V_W_E;
    X_WE_.translation() += kPeriod * V_W_E.linear;
    X_WE_.linear() = math::exp_rotation(kPeriod * V_W_E.angular) * X_WE_.linear();
  }

  void read(robot_state_t& state) const {
    state.joint_count = 7;  // q, dq and tau stay at zero: there are no joints
    Eigen::Map<Eigen::Vector3d>(state.position) = X_WE_.translation();
    math::wxyz_from_rotation(X_WE_.linear(), state.quaternion);
    Eigen::Map<math::Vector6d>(state.twist) = V_W_E_.vector();
  }

  /// What the sensor exerts on the hand: its weight, in axes S, which are those of E. A sensor
  /// without noise would be taken for one that has stopped.
  void read(ft_wrench_t& reading) {
    Eigen::Map<math::Vector6d> wrench(reading.wrench);
    wrench << X_WE_.linear().transpose() * Eigen::Vector3d(0, 0, weight_), Eigen::Vector3d::Zero();
    for (int i = 0; i < 6; ++i) wrench(i) += (i < 3 ? 0.02 : 1e-3) * noise_(random_);
  }

 private:
  double weight_;  // N
  math::Pose X_WE_ = math::Pose::Identity();
  math::Twist V_W_E_;
  std::mt19937 random_{1};
  std::normal_distribution<double> noise_;
};

std::atomic<bool> stop{false};

int run(const Options& options) {
  bus::Access access;
  access.start_us = bus::wall_clock_us();  // what was sent before now is refused
  if (!options.key_file.empty()) access.key = bus::read_key_file(options.key_file);
  const auto control = bus::make_lcm_bus(options.url);
  TwistInput input(*control, options, access);
  IdealArm arm(options);
  bus::TypedPublisher<robot_state_t> states(*control, "ROBOT_STATE");
  bus::TypedPublisher<ft_wrench_t> wrenches(*control, "FT_WRENCH");
  const std::int64_t session = bus::random_session();
  bus::Stamp state_stamp(session), wrench_stamp(session);
  control->start_without_thread();

  using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC, as times of arrival
  robot_state_t state{};
  ft_wrench_t wrench{};
  auto next = Clock::now();
  for (int tick = 0; !stop; ++tick) {
    control->receive(0);
    arm.command(input.read(Clock::now().time_since_epoch() / std::chrono::nanoseconds(1)));
    const std::int64_t utime = bus::wall_clock_us();
    arm.read(wrench);
    wrench_stamp.put(wrench, utime);
    wrenches.publish(wrench);
    if (tick % 2 == 0) {
      arm.read(state);
      state_stamp.put(state, utime);
      states.publish(state);
    }
    next += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kPeriod));
    if (next < Clock::now()) next = Clock::now();  // late: nothing is caught up
    std::this_thread::sleep_until(next);
  }
  const Counts counts = input.counts();
  std::printf("%lld obeyed, %lld refused, %lld rejected, %lld stops for want of commands\n",
              static_cast<long long>(counts.obeyed), static_cast<long long>(counts.refused),
              static_cast<long long>(counts.rejected), static_cast<long long>(counts.stops));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("driver_template moves an ideal flange as palpated commands: a driver to copy.");
  Options options;
  app.add_option("--url", options.url, "control URL")->capture_default_str();
  app.add_option("--key", options.key_file, "file of the key that the daemon has");
  app.add_option("--linear-limit", options.linear_limit, "m/s")->check(CLI::Range(0.0, 2.0));
  app.add_option("--angular-limit", options.angular_limit, "rad/s")->check(CLI::Range(0.0, 6.0));
  app.add_option("--mass", options.mass, "kg, of the hand")->check(CLI::Range(0.0, 50.0));
  app.add_option("--position", options.position, "of the flange at first, m")->expected(3);
  CLI11_PARSE(app, argc, argv);
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { stop = true; });
  try {
    return run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
