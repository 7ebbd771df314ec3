#include "rt/daemon/stepped_clock.hpp"

#include <gtest/gtest.h>

#include <palpate/robot_state_t.hpp>
#include <palpate/twist_command_t.hpp>

#include "rt/bus/text.hpp"

namespace palpate::daemon {
namespace {

/// A daemon that is stepped over in-memory buses, and the peer at the other end.
class SteppedClockTest : public ::testing::Test {
 protected:
  static constexpr std::int64_t kPeriodUs = 1000;

  void tick(std::int64_t number, std::int64_t session = 5) {
    sim_tick_t message{};
    message.session = session;
    message.tick = number;
    message.period_us = kPeriodUs;
    message.utime = kPeriodUs * number;
    ticks_.publish(message);
  }
  void robot_state(std::int64_t arrival_ns) {
    robot_state_t message{};
    message.session = 5;
    message.seq = ++seq_;
    message.joint_count = 7;
    message.quaternion[0] = 1;
    bus::set_time(*hub_, arrival_ns);
    robot_.publish(message);
  }
  const sensing::Stream<sensing::RobotState>& robot() { return daemon_.inputs().signals().robot; }
  std::vector<std::int64_t> answers() {
    std::vector<std::int64_t> ticks;
    tick_done_t message{};
    std::int64_t arrival_ns = 0;
    while (done_.take(message, arrival_ns)) ticks.push_back(message.tick);
    return ticks;
  }

  std::shared_ptr<bus::MemoryHub> hub_ = bus::make_memory_hub();
  std::unique_ptr<bus::MessageBus> ours_ = bus::make_memory_bus(hub_);
  std::unique_ptr<bus::MessageBus> theirs_ = bus::make_memory_bus(hub_);
  Daemon daemon_{
      config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml"),
      *theirs_, *theirs_, Mode::kDeterministic, 1};
  SteppedClock clock_{*theirs_, 1};
  bus::TypedPublisher<sim_tick_t> ticks_{*ours_, "SIM_TICK"};
  bus::TypedPublisher<robot_state_t> robot_{*ours_, "ROBOT_STATE"};
  bus::TypedSubscription<tick_done_t> done_{*ours_, "TICK_DONE", 64};
  std::int32_t seq_ = 0;
};

TEST_F(SteppedClockTest, RunsOneCycleATickHoweverOftenItIsSent) {
  EXPECT_FALSE(clock_.run_pending(daemon_));
  for (const std::int64_t number : {1, 1, 2, 2, 2, 3, 1}) tick(number);
  EXPECT_TRUE(clock_.run_pending(daemon_));
  EXPECT_EQ(daemon_.counters().cycles, 3);
  EXPECT_EQ(answers(), (std::vector<std::int64_t>{1, 1, 2, 2, 2, 3, 1}));
}

TEST_F(SteppedClockTest, ARestartedSimulatorIsFollowedFromItsFirstTick) {
  tick(500);
  tick(1, 6);
  clock_.run_pending(daemon_);
  EXPECT_EQ(daemon_.counters().cycles, 2);
}

TEST_F(SteppedClockTest, AgesAreOfSimulatedTimeWhateverTheClockOfArrivalSays) {
  for (const std::int64_t arrival_ns : {std::int64_t{0}, std::int64_t{77'000'000'000'000}}) {
    robot_state(arrival_ns);
    tick(1, 10 + arrival_ns);
    clock_.run_pending(daemon_);
    EXPECT_EQ(robot().freshness, Freshness::kNew);
    EXPECT_EQ(robot().age, 0);
    for (int n = 1; n <= 40; ++n) {
      tick(1 + n, 10 + arrival_ns);
      clock_.run_pending(daemon_);
      EXPECT_EQ(robot().freshness, Freshness::kOld);
      EXPECT_NEAR(robot().age, 1e-6 * kPeriodUs * n, 1e-12);
    }
  }
}

TEST_F(SteppedClockTest, ARestartedSimulatorMakesNothingYounger) {
  robot_state(0);
  for (std::int64_t number = 1; number <= 30; ++number) tick(number);
  clock_.run_pending(daemon_);
  tick(1, 6);
  clock_.run_pending(daemon_);
  EXPECT_GT(robot().age, 0);
}

}  // namespace
}  // namespace palpate::daemon
