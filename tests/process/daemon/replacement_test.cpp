#include <cmath>
#include <cstdlib>
#include <palpate/component_event_t.hpp>
#include <palpate/shape_target_t.hpp>

#include "tests/process/daemon/daemon_process.hpp"
#include "tests/process/daemon/robot.hpp"

namespace palpate {
namespace {

using std::chrono::milliseconds;
using support::ChildProcess;

struct Request {
  const char* slot;
  const char* component;
  const char* parameters;
  bool good;
};

// After one round everything is as before.
constexpr Request kRound[] = {
    {"object", "", "order: linear", true},
    {"deformation", "corotational_dynamic", "", true},
    {"control", "", "provider: kinematic", true},
    {"deformation", "no_such_model", "", false},
    {"estimation", "force_driven", "variant: repaired", true},
    {"sensing", "ft_tare_only", "", true},
    {"object", "", "mesh: {box: {size: [2, 0.06, 0.06], cells: [5, 1, 1]}}", false},
    {"all", "",
     "{object: {order: quadratic}, deformation: {component: corotational_quasistatic}, "
     "control: {provider: fem}, estimation: {component: pose_driven, variant: nothing}}",
     false},
    {"estimation", "pose_driven", "", true},
    {"sensing", "ft_newton_euler",
     "payload: {mass: 4.8, center_of_mass: [0.0015, -0.00065, 0.1137]}", true},
    {"all", "",
     "{object: {order: quadratic}, deformation: {component: corotational_quasistatic}, "
     "control: {provider: fem}}",
     true},
};

class ReplacementProcess : public DaemonProcess {
 protected:
  void SetUp() override {
    DaemonProcess::SetUp();
    if (IsSkipped()) return;
    events_ = std::make_unique<bus::TypedSubscription<component_event_t>>(late_bus(),
                                                                          "COMPONENT_EVENT", 64);
    late_->start();
  }
  void TearDown() override {
    if (late_) late_->stop();
    DaemonProcess::TearDown();
  }
  bus::MessageBus& late_bus() {
    late_ = bus::make_lcm_bus(housekeeping_url_);
    return *late_;
  }

  void send(const Request& request, std::int64_t counter) {
    component_command_t message{};
    message.session = 42;
    message.counter = counter;
    bus::put_text(message.slot, request.slot);
    bus::put_text(message.event, "replace");
    bus::put_text(message.component, request.component);
    bus::put_text(message.parameters, request.parameters);
    bus::TypedPublisher<component_command_t>(*control_, "COMPONENT_COMMAND").publish(message);
  }
  /// Sends, as any client does, repeatedly until answered (a datagram may be lost); returns the
  /// final answer, or empty if there was none within 20 s.
  std::string outcome(const Request& request, std::int64_t counter) {
    const auto begin = std::chrono::steady_clock::now();
    auto next = begin;
    component_event_t event;
    std::int64_t arrival_ns = 0;
    while (std::chrono::steady_clock::now() < begin + std::chrono::seconds(20)) {
      if (std::chrono::steady_clock::now() >= next) {
        send(request, counter);
        next += std::chrono::seconds(2);
      }
      watch_commands();
      while (events_->take(event, arrival_ns)) {
        const std::string text = bus::get_text(event.event);
        reason_ = bus::get_text(event.reason);
        if (event.command_counter == counter && text != "replacing") return text;
      }
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    return "";
  }
  /// Commands must be finite and the change between consecutive ones must respect the gate's
  /// acceleration limit.
  void watch_commands() {
    twist_command_t twist;
    std::int64_t arrival_ns = 0;
    while (twist_->take(twist, arrival_ns)) {
      const double gap = last_seq_ > 0 ? twist.seq - last_seq_ : 1;
      for (int i = 0; i < 3; ++i) {
        if (!std::isfinite(twist.twist[i])) ++not_finite_;
        const double change = std::abs(twist.twist[i] - last_twist_[i]) / gap;
        largest_change_ = std::max(largest_change_, change);
        last_twist_[i] = twist.twist[i];
      }
      last_seq_ = twist.seq;
      ++commands_;
    }
  }

  std::unique_ptr<bus::MessageBus> late_;
  std::unique_ptr<bus::TypedSubscription<component_event_t>> events_;
  std::string reason_;
  double last_twist_[3] = {};
  std::int32_t last_seq_ = 0;
  int not_finite_ = 0, commands_ = 0;
  double largest_change_ = 0;  // m/s per tick
};

/// Overruns of cycles, in some of them.
struct Overruns {
  std::int64_t cycles = 0, late = 0;
  double share() const { return cycles > 0 ? static_cast<double>(late) / cycles : 0; }
  void add(const health_t& from, const health_t& to) {
    cycles += to.cycles - from.cycles;
    late += to.overruns - from.overruns;
  }
};

/// PALPATE_REPLACEMENTS=10000 for the long run. After every round of requests the daemon runs
/// undisturbed for the same time, so that effects of the machine can be distinguished from those of
/// the replacement.
TEST_F(ReplacementProcess, ManyUnderLoadLeaveNoTrace) {
  const char* wanted = std::getenv("PALPATE_REPLACEMENTS");
  int count = wanted != nullptr ? std::max(22, std::atoi(wanted)) : 44;
  ChildProcess daemon(command());
  health_t health;
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.cycles > 200; }, health))
      << daemon.output();
  Robot robot(control_url_);
  std::this_thread::sleep_for(milliseconds(300));
  send_event("start", 1);
  ASSERT_TRUE(wait_health([](const health_t& h) { return h.state == 2; }, health))
      << bus::get_text(health.reason);
  shape_target_t target{};
  target.session = 42;
  target.revision = 1;
  target.chunks = 1;
  bus::put_text(target.kind, "point");
  target.value_count = 3;
  target.values[0] = 0.25, target.values[1] = 0.03, target.values[2] = 0.08;
  bus::TypedPublisher<shape_target_t>(*control_, "SHAPE_TARGET").publish(target);

  constexpr double kMostGrowth = 1;  // MB
  constexpr int kRoundLength = static_cast<int>(std::size(kRound));
  count += (kRoundLength - count % kRoundLength) % kRoundLength;
  std::int64_t counter = 1;
  int replaced = 0, refused = 0;
  double resident = 0, growth = 0;
  int again = 0;
  Overruns replacing, resting;
  ASSERT_TRUE(next_health(health));
  for (int i = 0; i < count; ++i) {
    const Request& request = kRound[i % kRoundLength];
    std::string ended;
    do {
      ended = outcome(request, ++counter);
    } while (ended == "refused" && reason_ == "another replacement is under way");
    ASSERT_EQ(ended, request.good ? "replaced" : "refused")
        << i << " " << request.slot << ": " << reason_ << "\n"
        << daemon.output();
    ++(request.good ? replaced : refused);
    if (i == 2 * kRoundLength - 1) resident = resident_megabytes(daemon.pid());
    if (i % kRoundLength != kRoundLength - 1) continue;
    const health_t before = health;
    ASSERT_TRUE(next_health(health));
    replacing.add(before, health);
    const health_t replaced_all = health;
    const std::int64_t end = 2 * health.cycles - before.cycles;
    ASSERT_TRUE(wait_health([&](const health_t& h) { return h.cycles >= end; }, health));
    resting.add(replaced_all, health);
    if (i + 1 < count) continue;
    growth = resident_megabytes(daemon.pid()) - resident;
    // A leak grows by the same amount again; memory cached by an allocator for its threads does
    // not.
    if (growth < kMostGrowth || again++ == 2) continue;
    resident += growth;
    count += 2 * kRoundLength;
  }
  const std::int64_t cycles = health.cycles;
  ASSERT_TRUE(wait_health([&](const health_t& h) { return h.cycles > cycles + 1000; }, health));
  std::printf(
      "%d replaced, %d refused; overruns in %.3f %% of %lld cycles, in %.3f %% of %lld between the "
      "rounds; %lld allocations of the loop, memory %+.2f MB, %d commands, largest change %.2e m/s "
      "a "
      "tick\n",
      replaced, refused, 100 * replacing.share(), static_cast<long long>(replacing.cycles),
      100 * resting.share(), static_cast<long long>(resting.cycles),
      static_cast<long long>(health.allocations), growth, commands_, largest_change_);
  EXPECT_EQ(not_finite_, 0);
  EXPECT_GT(commands_, 0);
  // Braking may take 0.08 m/s in 100 ms (the gate's stop), which is above the acceleration limit.
  EXPECT_LE(largest_change_, 1.02e-3 * 0.8);
  EXPECT_LE(health.allocations, 0);
  EXPECT_LT(growth, kMostGrowth);
  EXPECT_LT(replacing.share(), resting.share() + 0.05) << "a machine that is merely busy aside";
  EXPECT_TRUE(daemon.running());
}

}  // namespace
}  // namespace palpate
