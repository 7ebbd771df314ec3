// Failing components, late cycles, replacement under load.

#include <cmath>

#include "tools/lab/faults/faulty_sensor.hpp"
#include "tools/lab/faults/rows.hpp"
#include "tools/lab/faults/scenario.hpp"
#include "tools/lab/faults/wishes.hpp"

namespace palpate::faults {
namespace {

using pipeline::LifeCycle;

FaultySensor& put_faulty_sensor(Replay& replay) {
  pipeline::Pipeline& pipeline = replay.daemon().pipeline();
  auto faulty = std::make_unique<FaultySensor>(pipeline.exchange_sensor_model(0, nullptr));
  FaultySensor& reference = *faulty;
  pipeline.exchange_sensor_model(0, std::move(faulty));
  return reference;
}

/// Braking must begin in the cycle of the error; the fault stays until a reset.
RunResult run_error(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "error");
  const int begin = 250 + static_cast<int>(random.below(100));
  const int length = 1 + static_cast<int>(random.below(50));
  constexpr int kReset = 600, kStart = 610, kRowTicks = 900;
  Replay replay(bench.recording);
  FaultySensor& sensor = put_faulty_sensor(replay);
  const Trace trace = replay.run(bench.recording.stream, kRowTicks, [&](int tick, daemon::Now&) {
    const bool wrong = tick >= begin && tick < begin + length;
    sensor.trouble = wrong ? FaultySensor::Trouble::kError : FaultySensor::Trouble::kNone;
    if (tick == kReset) replay.user().send({"reset"}, 0);
    if (tick == kStart) replay.user().send({"start"}, 0);
    return true;
  });
  const Window window{1e-3 * begin, 1e-3 * kStart};
  RunResult result = judge(trace, bench.reference, window, true);
  result.outcome = std::max(result.outcome, Outcome::kSafeStop);
  int braked = begin;
  while (braked < kReset && !(trace.cycles[braked - 1].speed < trace.cycles[braked - 2].speed))
    ++braked;
  result.measured = 1e3 * kTick * (braked - begin);
  const double zero = zero_after(trace, window.begin, 1e-3 * kReset);
  if (zero < 0 || zero > kZeroWithin) result.fail("no zero command within 100 ms");
  if (trace.cycles[kReset - 2].state != LifeCycle::kFaulted) result.fail("the fault is not kept");
  if (trace.cycles.back().state != LifeCycle::kActive) result.note("not active after reset");
  return result;
}

RunResult run_bad_output(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "bad output");
  const Window window{0.25 + random.uniform(0, 0.1), 0.5};
  constexpr double kBad[] = {std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1e308, -1e12};
  Replay replay(bench.recording);
  FaultySensor& sensor = put_faulty_sensor(replay);
  sensor.number = static_cast<int>(random.below(6));
  sensor.value = kBad[random.below(4)];
  const Trace trace = replay.run(bench.recording.stream, 700, [&](int, daemon::Now& now) {
    sensor.trouble = window.holds(now.monotonic_ns) ? FaultySensor::Trouble::kBadNumbers
                                                    : FaultySensor::Trouble::kNone;
    return true;
  });
  RunResult result = judge(trace, bench.reference, window, true);
  const double zero = zero_after(trace, window.begin, window.end);
  if (zero < 0) result.fail("the command does not come to zero");
  result.measured = 1e3 * zero;
  return result;
}

/// Cycles that the loop misses, by the overrun policy: 6 ms of lateness within 20 ms degrade it, 20
/// ms without a command stop it until a reset.
RunResult run_overruns(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "overruns");
  const int begin = 250 + static_cast<int>(random.below(100));
  struct Case {
    int bursts, missed;
    LifeCycle expected;
  };
  const Case cases[] = {
      {3, 2, LifeCycle::kDegraded},
      {1, 6 + static_cast<int>(random.below(13)), LifeCycle::kDegraded},
      {1, 21 + static_cast<int>(random.below(40)), LifeCycle::kFaulted},
      {1, 1 + static_cast<int>(random.below(5)), LifeCycle::kActive},
      {2, 2, LifeCycle::kActive},
  };
  const Case& chosen = cases[random.below(5)];
  const int end = begin + chosen.bursts * (chosen.missed + 1);  // the last wake-up is at end - 1
  int missed = 0;
  Replay replay(bench.recording, {}, daemon::Mode::kRealTime);
  const Trace trace = replay.run(bench.recording.stream, 700, [&](int tick, daemon::Now& now) {
    const bool misses =
        tick >= begin && tick < end && (tick - begin) % (chosen.missed + 1) != chosen.missed;
    if (misses) return ++missed, false;
    now.lateness_ns = 1'000'000LL * std::exchange(missed, 0);
    return true;
  });
  const Window window{1e-3 * (end - 1), 1e-3 * end};
  RunResult result = judge(trace, bench.reference, window, true);
  int seen = end - 1;
  while (seen <= 700 && trace.cycles[seen - 1].state == LifeCycle::kActive) ++seen;
  const LifeCycle state = seen > 700 ? LifeCycle::kActive : trace.cycles[seen - 1].state;
  result.measured = seen > 700 ? 0 : 1e3 * kTick * (seen - (end - 1));
  if (state != chosen.expected)
    result.fail(std::string("state ") + pipeline::name(state) + ", not " +
                pipeline::name(chosen.expected));
  const LifeCycle last =
      chosen.expected == LifeCycle::kFaulted ? LifeCycle::kFaulted : LifeCycle::kActive;
  if (trace.cycles.back().state != last)
    result.fail(std::string("ends ") + pipeline::name(trace.cycles.back().state));
  return result;
}

/// A target so far away that the controller's command overflows: an error of the controller. Its
/// fallback, if it has one, takes over in the same cycle; without one the loop stops.
Scenario overflow(const Bench& bench, std::uint64_t seed, bool with_fallback) {
  math::Random random(seed, "overflow");
  Scenario scenario;
  scenario.overrides = {
      std::string("control={provider: fem, law: proportional_twist, gain: 50") +
      (with_fallback ? ", fallback: {provider: fem, law: proportional_twist, gain: 0.001}}" : "}")};
  const int tick = 250 + static_cast<int>(random.below(100));
  scenario.stream = bench.recording.stream;
  scenario.ticks = 800;
  scenario.window = {1e-3 * tick, 1e-3 * 600};
  Eigen::Vector3d target = bench.recording.target;
  for (double& x : target)
    if (random.below(2) == 0) x = 1e308 * (random.below(2) == 0 ? 1 : -1);
  if (target == bench.recording.target) target.x() = 1e308;
  scenario.acts.push_back(
      {tick, [target](client::Client& user) { user.set_target(message_of(target), 0); }});
  return scenario;
}

RunResult judge_overflow(const Bench& bench, const Scenario& scenario, LifeCycle expected) {
  const Trace trace = play(bench, scenario);
  const Window& window = scenario.window;
  RunResult result = judge(trace, bench.reference, window, true);
  result.measured = 1e3 * result.detected;
  if (trace.cycles.back().state != expected)
    result.fail(std::string("ends ") + pipeline::name(trace.cycles.back().state));
  const double zero = zero_after(trace, window.begin, 1e-3 * scenario.ticks);
  if (expected == LifeCycle::kFaulted && (zero < 0 || zero > kZeroWithin))
    result.fail("no zero command within 100 ms");
  if (expected == LifeCycle::kDegraded && !trace.cycles.back().command_valid)
    result.fail("the fallback has no command");
  return result;
}

Row overflow_row(bool with_fallback) {
  const LifeCycle expected = with_fallback ? LifeCycle::kDegraded : LifeCycle::kFaulted;
  return scenario_row(
      {"12",
       std::string("controller overflows") + (with_fallback ? ", with fallback" : ""),
       with_fallback ? "the fallback commands within 1 T, reported" : "faulted within 1 T, kept",
       "ms",
       1,
       false,
       {}},
      [with_fallback](const Bench& bench, std::uint64_t seed) {
        return overflow(bench, seed, with_fallback);
      },
      [expected](const Bench& bench, const Scenario& scenario) {
        return judge_overflow(bench, scenario, expected);
      });
}

/// The whole process is stopped, much longer than on a busy machine.
Scenario held_still(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "held still");
  Scenario scenario;
  scenario.overrides = {"loop.degraded_after_ms=150", "loop.overrun_window_ms=400",
                        "loop.safe_stop_after_ms=600"};
  scenario.stream = bench.recording.stream;
  scenario.ticks = 1800;
  const int tick = 250 + static_cast<int>(random.below(100));
  const bool stops = random.below(2) == 0;
  scenario.held = {tick, stops ? 700 + static_cast<int>(random.below(100))
                               : 250 + static_cast<int>(random.below(100))};
  scenario.window = {1e-3 * tick, 1e-3 * (tick + scenario.held.length)};
  scenario.must_show = false;  // before it continues: no thread can report it
  return scenario;
}

RunResult judge_held_still(const Bench& bench, const Scenario& scenario) {
  const Trace trace = play(bench, scenario);
  const Window after{scenario.window.end, scenario.window.end};
  RunResult result = judge(trace, bench.reference, after, true);
  result.measured = 1e3 * result.detected;
  const LifeCycle expected = scenario.held.length > 600 ? LifeCycle::kFaulted : LifeCycle::kActive;
  if (trace.cycles.back().state != expected)
    result.fail(std::string("ends ") + pipeline::name(trace.cycles.back().state));
  return result;
}

constexpr int kRequests = 10;

Scenario replacements(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "replacement");
  Scenario scenario;
  scenario.window = {0.25, 1.6};
  scenario.ticks = 1700;
  scenario.stream = lose(bench.recording.stream, sensors_in(scenario.window), 0.05, random);
  for (int i = 0; i < kRequests; ++i) {
    const Wish& wish = kWishes[random.below(std::size(kWishes))];
    scenario.acts.push_back(
        {250 + 130 * i, [wish](client::Client& user) {
           user.send({"replace", wish.slot, "", wish.component, wish.parameters}, 0);
         }});
  }
  return scenario;
}

RunResult judge_replacements(const Bench& bench, const Scenario& scenario) {
  const Trace trace = play(bench, scenario);
  RunResult result = judge(trace, bench.reference, scenario.window, true);
  result.measured = trace.largest_step;
  int answered = 0;
  for (const EventNote& event : trace.events)
    answered += event.event == "replaced" || event.event == "refused" ? 1 : 0;
  if (answered != kRequests) result.fail(std::to_string(answered) + " answers to 10 requests");
  if (trace.cycles.back().state != LifeCycle::kActive) result.note("does not end active");
  return result;
}

}  // namespace

std::vector<Row> component_rows() {
  return {
      {"12", "component returns an error", "command brakes within 1 T, kept until reset", "ms", 1,
       false, run_error},
      {"12", "component gives bad numbers", "zero command in 100 ms", "ms", 100, false,
       run_bad_output},
      {"12", "cycles overrun", "degraded at 6 ms, safe stop at 20 ms, within 1 T", "ms", 1, false,
       run_overruns},
      overflow_row(false),
      overflow_row(true),
      scenario_row({"12",
                    "process held still, 250 to 800 ms",
                    "degraded or safe stop by its length, within 1 T of its continuation",
                    "ms",
                    1,
                    false,
                    {}},
                   held_still, judge_held_still),
      scenario_row({"14",
                    "10 replacements, some failing",
                    "command step within the limit of the gate",
                    "of limit",
                    1 + 1e-6,
                    false,
                    {}},
                   replacements, judge_replacements),
  };
}

}  // namespace palpate::faults
