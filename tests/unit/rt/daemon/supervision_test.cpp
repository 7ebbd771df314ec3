// The daemon's statistics and reports of its own loop and of its inputs, on a virtual clock.

#include <gtest/gtest.h>

#include <algorithm>
#include <palpate/component_event_t.hpp>
#include <palpate/ft_wrench_t.hpp>
#include <palpate/imu_t.hpp>

#include "rt/bus/text.hpp"
#include "rt/daemon/daemon.hpp"

namespace palpate::daemon {
namespace {

constexpr std::int64_t kSupervisionMillisecond = 1'000'000;

class Supervision : public ::testing::Test {
 protected:
  Supervision()
      : hub_(bus::make_memory_hub()),
        outside_(bus::make_memory_bus(hub_)),
        inside_(bus::make_memory_bus(hub_)),
        daemon_(config::Node::load_file(PALPATE_SOURCE_DIR "/rt/config/examples/bar_long_soft.yaml",
                                        {"object.mesh={box: {size: [0.5, 0.06, 0.06], cells: [4, "
                                         "1, 1]}}"}),
                *inside_, *inside_, Mode::kRealTime, 1) {}

  /// One cycle a millisecond after the previous one; returns the published events.
  std::vector<component_event_t> tick(std::int64_t lateness_ns = 0, std::int64_t missed = 0) {
    now_ns_ += kSupervisionMillisecond;
    bus::set_time(*hub_, now_ns_);
    std::vector<bus::Published> published;
    bus::record(*hub_, &published);
    daemon_.tick({now_ns_, now_ns_ / 1000, lateness_ns, missed});
    bus::record(*hub_, nullptr);
    std::vector<component_event_t> events;
    for (const bus::Published& message : published) {
      if (message.channel != "COMPONENT_EVENT") continue;
      events.emplace_back();
      events.back().decode(message.data.data(), 0, static_cast<int>(message.data.size()));
    }
    return events;
  }

  static int count(const std::vector<component_event_t>& events, const std::string& name) {
    return static_cast<int>(std::count_if(
        events.begin(), events.end(),
        [&](const component_event_t& event) { return bus::get_text(event.event) == name; }));
  }

  std::shared_ptr<bus::MemoryHub> hub_;
  std::unique_ptr<bus::MessageBus> outside_, inside_;
  Daemon daemon_;
  std::int64_t now_ns_ = 1'000'000'000;
};

TEST_F(Supervision, ALongCycleIsAnOverrunAsALateWakeUpIs) {
  for (int i = 0; i < 10; ++i) tick(50'000);
  EXPECT_EQ(daemon_.counters().overruns, 0);
  tick(3 * kSupervisionMillisecond, 3);  // woken up late
  EXPECT_EQ(daemon_.counters().overruns, 1);
  EXPECT_EQ(daemon_.counters().overrun_ns, 3 * kSupervisionMillisecond);
  tick(50'000, 1);  // its cycle therefore ended late: the same overrun, but longer
  EXPECT_EQ(daemon_.counters().overruns, 1);
  EXPECT_EQ(daemon_.counters().overrun_ns, 4 * kSupervisionMillisecond);
  tick(50'000, 2);  // punctual, after a cycle that lasted three periods
  EXPECT_EQ(daemon_.counters().overruns, 2);
  EXPECT_EQ(daemon_.counters().overrun_ns, 6 * kSupervisionMillisecond);
}

TEST_F(Supervision, ALoopThatIsStartedInItsFirstCycleIsNotChargedWithTheSetUp) {
  bus::TypedPublisher<component_command_t> commands(*outside_, "COMPONENT_COMMAND");
  component_command_t command{};
  command.session = 3;
  command.counter = 1;
  bus::put_text(command.slot, "all");
  bus::put_text(command.event, "start");
  commands.publish(command);
  tick();
  ASSERT_TRUE(daemon_.pipeline().is_running());
  EXPECT_LE(daemon_.counters().allocations, 0);
  EXPECT_LT(daemon_.counters().page_faults, 100) << "the set-up takes thousands";
}

TEST_F(Supervision, CommandsWithoutEndAreTakenAFewACycle) {
  tick();
  bus::TypedPublisher<component_command_t> commands(*outside_, "COMPONENT_COMMAND");
  for (int i = 1; i <= 7; ++i) {
    component_command_t command{};
    command.session = 3;
    command.counter = i;
    bus::put_text(command.slot, "all");
    bus::put_text(command.event, "zero");
    commands.publish(command);
  }
  EXPECT_EQ(count(tick(), "zero"), 4);
  EXPECT_EQ(count(tick(), "zero"), 3);
  EXPECT_EQ(count(tick(), "zero"), 0);
}

TEST_F(Supervision, AWrongTypeIsNamedAtOnceAndThenOnceASecond) {
  tick();
  bus::TypedPublisher<imu_t> wrong(*outside_, "FT_WRENCH");
  int reports = 0;
  for (int i = 0; i < 2500; ++i) {
    wrong.publish(imu_t{});
    const auto events = tick();
    reports += count(events, "wrong type");
    if (i > 0 || events.empty()) continue;
    const std::string reason = bus::get_text(events.back().reason);
    EXPECT_NE(reason.find("FT_WRENCH"), std::string::npos) << reason;
  }
  EXPECT_EQ(reports, 3);
  // A silent input ends the reports.
  reports = 0;
  for (int i = 0; i < 2500; ++i) reports += count(tick(), "wrong type");
  EXPECT_LE(reports, 1);
}

}  // namespace
}  // namespace palpate::daemon
