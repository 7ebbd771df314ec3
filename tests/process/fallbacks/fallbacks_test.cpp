// A failing component in a running daemon, and its fallback, observed from outside. The daemon is
// the one of palpated, in a separate process whose components have injectable faults.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>

#include "rt/bus/session.hpp"
#include "rt/daemon/daemon.hpp"
#include "tests/support/faulty_slots.hpp"
#include "tools/lab/faults/fault_wire.hpp"
#include "tools/lab/faults/faulty_sensor.hpp"
#include "tools/lab/faults/process_judge.hpp"

namespace palpate {
namespace {

constexpr int kTicks = 1500;       // ms, of the sensors' messages
constexpr int kMovesBefore = 300;  // cycles until the fault
constexpr int kGoesOn = 300;       // cycles after it

struct Case {
  const char* name;
  const char* override;
  const char* event;  // the initial component
  /// Installs a component that fails once `broken` is true.
  void (*put_in)(pipeline::ComponentSet& components, const bool& broken);
};

/// Fails on request from outside.
class SwitchedSensor final : public faults::FaultySensor {
 public:
  SwitchedSensor(std::unique_ptr<sensing::SensorModel> good, const bool& broken)
      : FaultySensor(std::move(good)), broken_(broken) {}
  UpdateResult update(const sensing::Signals& signals,
                      sensing::ContactSet& contacts) noexcept override {
    trouble = broken_ ? Trouble::kError : Trouble::kNone;
    return FaultySensor::update(signals, contacts);
  }

 private:
  const bool& broken_;
};

void put_in_sensor(pipeline::ComponentSet& components, const bool& broken) {
  registry::SensorFallback& pair = *components.sensing[0].fallback;
  std::unique_ptr<sensing::SensorModel> first;
  pair.exchange(first);
  first = std::make_unique<SwitchedSensor>(std::move(first), broken);
  pair.exchange(first);
}

void put_in_transformer(pipeline::ComponentSet& components, const bool& broken) {
  auto faulty = std::make_unique<support::FaultyTransformer>(broken);
  auto& its_good = faulty->good;
  std::unique_ptr<contact::ForceTransformer> first = std::move(faulty);
  components.contact[0].fallback->exchange(first);
  its_good = std::move(first);
}

void put_in_feature(pipeline::ComponentSet& components, const bool& broken) {
  auto faulty = std::make_unique<support::FaultyFeature>(broken);
  faulty->good = std::move(components.feature);
  components.feature = std::move(faulty);
}

const Case kCases[] = {
    {"sensing", "sensing.0.fallback={component: ft_tare_only}", "wrist: fallback", put_in_sensor},
    {"contact", "contact.0.fallback={component: area_coordinates}", "grasp: fallback",
     put_in_transformer},
    {"feature",
     "feature.fallback={component: point, rest_points: [[0.25, 0.03, 0.06]], components: [2]}",
     "feature: fallback", put_in_feature}};

config::Node configuration(const Case& of) {
  return faults::configuration({of.override, "loop.degraded_after_ms=5000",
                                "loop.overrun_window_ms=5000", "loop.safe_stop_after_ms=5000"});
}

/// Runs until some time after the fault. 0: the fallback commanded in the cycle of the fault.
int run_daemon(const Case& of, const runs::Urls& urls) {
  const config::Node root = configuration(of);
  const auto control = bus::make_lcm_bus(urls.control);
  const auto housekeeping = bus::make_lcm_bus(urls.housekeeping);
  daemon::Daemon daemon(root, *control, *housekeeping, daemon::Mode::kRealTime,
                        bus::random_session());
  pipeline::Pipeline& pipeline = daemon.pipeline();
  bool broken = false, in_same_cycle = false;
  of.put_in(pipeline.components_at_setup(), broken);
  control->start();
  const auto speed = [&] { return pipeline.gate_output(0).V_W_E.linear.norm(); };
  int moved = 0;
  std::atomic<bool> ended{false};
  loop::FixedRateLoop(daemon.settings().loop)
      .run(ended, [&](const loop::FixedRateLoop::Tick& tick) {
        const double before = speed();
        moved += before > 1e-3 ? 1 : 0;
        const bool fault = !broken && moved >= kMovesBefore && before > 1e-3;
        broken = broken || fault;
        daemon.tick({tick.now_ns, bus::wall_clock_us(), tick.lateness_ns, tick.missed});
        if (fault) in_same_cycle = pipeline.on_fallback() && speed() > 0.9 * before;
        ended = moved >= kMovesBefore + kGoesOn;
      });
  control->stop();
  return in_same_cycle ? 0 : 1;
}

class FallbackProcess : public ::testing::TestWithParam<int> {};

TEST_P(FallbackProcess, CommandsWithinAPeriodAndIsReported) {
  const Case& of = kCases[GetParam()];
  const runs::Urls urls = runs::private_urls();
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    alarm(60 * PALPATE_SLOWNESS);
    _exit(run_daemon(of, urls));
  }
  const faults::Recording recording = faults::record_loop(kTicks);
  faults::FaultWire wire(urls);
  for (int i = 0; i < 2000 && !wire.heard(); ++i) usleep(10'000);
  faults::Scenario scenario;
  scenario.stream = recording.stream;
  scenario.ticks = kTicks;
  wire.play(recording, scenario, [](int) {});
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0) << "no command of the fallback in the cycle of the fault";

  const faults::Trace trace =
      wire.trace(kTicks, registry::read_gate_limits(configuration(of)), faults::kTick);
  EXPECT_TRUE(trace.sound()) << trace.complaint;
  const auto event =
      std::find_if(trace.events.begin(), trace.events.end(),
                   [](const faults::EventNote& note) { return note.event == "fallback"; });
  ASSERT_NE(event, trace.events.end());
  EXPECT_EQ(event->reason.rfind(of.event, 0), 0u) << event->reason;
  // The state is reported once the fallback runs, and commands continue.
  int degraded = 0, still = 0;
  for (const faults::HealthNote& note : trace.health) {
    if (note.time_ns < event->time_ns - 20'000'000) continue;
    degraded += note.state == static_cast<int>(pipeline::LifeCycle::kDegraded) ? 1 : 0;
    EXPECT_NE(note.state, static_cast<int>(pipeline::LifeCycle::kFaulted));
  }
  EXPECT_GT(degraded, 0);
  const auto at = static_cast<std::size_t>(event->time_ns / 1'000'000);
  for (std::size_t i = at; i < std::min(at + kGoesOn / 2, trace.cycles.size()); ++i)
    still += trace.cycles[i].command_valid ? 0 : 1;
  EXPECT_EQ(still, 0) << "commands are valid all the time";
  EXPECT_LE(trace.largest_step, 1 + 1e-6);
}

std::string name_of(const ::testing::TestParamInfo<int>& info) { return kCases[info.param].name; }

INSTANTIATE_TEST_SUITE_P(Slots, FallbackProcess, ::testing::Range(0, 3), name_of);

}  // namespace
}  // namespace palpate
