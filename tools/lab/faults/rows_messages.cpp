// Messages that are lost, late, duplicated or of another type.

#include <palpate/channels.hpp>
#include <palpate/ft_wrench_t.hpp>

#include "tools/lab/faults/rows.hpp"
#include "tools/lab/faults/scenario.hpp"

namespace palpate::faults {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Fault from 0.25 s on, for half a second or as given, and time to recover.
constexpr Window kWindow{0.25, 0.75};
constexpr int kTicks = 900;

Scenario scenario_of(const Bench& bench, Stream faulted) {
  Scenario scenario;
  scenario.window = from_first(faulted, bench, kWindow);
  scenario.stream = std::move(faulted);
  scenario.ticks = kTicks;
  return scenario;
}

Row loss(double probability, const char* figure, double limit) {
  const std::string fault = "loss " + std::to_string(std::lround(100 * probability)) + " %";
  return scenario_row(
      {"1", fault, figure, "%", limit, false, {}},
      [probability](const Bench& bench, std::uint64_t seed) {
        math::Random random(seed, "loss");
        return scenario_of(bench,
                           lose(bench.recording.stream, sensors_in(kWindow), probability, random));
      },
      [](const Bench& bench, const Scenario& scenario) {
        const Trace trace = play(bench, scenario);
        RunResult result = judge(trace, bench.reference, scenario.window, true);
        const double before = shape_rmse(bench.reference, kWindow);
        result.measured = std::max(0.0, 100 * (shape_rmse(trace, kWindow) / before - 1));
        return result;
      });
}

Scenario bursts(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "bursts");
  return scenario_of(bench, lose_bursts(bench.recording.stream, kWindow, 0.020, random));
}

RunResult judge_bursts(const Bench& bench, const Scenario& scenario) {
  const Trace trace = play(bench, scenario);
  RunResult result = judge(trace, bench.reference, scenario.window, true);
  result.measured = 0;
  for (const EventNote& event : trace.events)
    if (event.event == "degraded" && event.time_ns > 250'000'000) {
      ++result.measured;
      result.note(event.reason);
    }
  return result;
}

Scenario disorder(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "reorder");
  const int reach = 1 + static_cast<int>(random.below(16));
  return scenario_of(bench, reorder(bench.recording.stream, sensors_in(kWindow), reach, random));
}

/// Measured: cycles that differ from those of `expected`.
RunResult judge_cycles(const Bench& bench, const Scenario& scenario, const Trace& expected) {
  const Trace trace = play(bench, scenario);
  RunResult result = judge(trace, bench.reference, scenario.window, true);
  result.measured = different_cycles(trace, expected, true);
  return result;
}

RunResult judge_disorder(const Bench& bench, const Scenario& scenario) {
  return judge_cycles(bench, scenario,
                      Replay(bench.recording).run(rising(scenario.stream), scenario.ticks));
}

Scenario duplicates(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "duplicates");
  const int most = 2 + static_cast<int>(random.below(99));
  return scenario_of(bench, duplicate(bench.recording.stream, sensors_in(kWindow), most, random));
}

RunResult judge_duplicates(const Bench& bench, const Scenario& scenario) {
  return judge_cycles(bench, scenario, bench.reference);
}

std::string hexadecimal(std::int64_t number) {
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(number));
  return text;
}

/// All or some of one channel's messages have a type drawn from the seed.
struct WrongType {
  std::string channel;
  std::int64_t fingerprint;
  Scenario scenario;
};

WrongType wrong_type(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "type");
  constexpr const char* kChannels[] = {channel::kFtWrench, channel::kImu, channel::kRobotState,
                                       channel::kHandState};
  WrongType wrong;
  wrong.channel = kChannels[random.below(4)];
  wrong.fingerprint = static_cast<std::int64_t>(random.next());
  const double share = random.uniform() < 0.5 ? 1.0 : random.uniform(0.1, 1.0);
  const Window window{0.25 + random.uniform(0, 0.1), 1.5};
  math::Random draws = random.split("draws");
  const Which in_window = sensors_in(window, wrong.channel);
  Scenario& scenario = wrong.scenario;
  scenario.stream = change_type(
      bench.recording.stream,
      [&](const bus::Published& m) { return in_window(m) && draws.uniform() < share; },
      wrong.fingerprint);
  scenario.window = from_first(scenario.stream, bench, window);
  scenario.ticks = 1700;
  return wrong;
}

RunResult run_wrong_type(const Bench& bench, std::uint64_t seed) {
  const WrongType wrong = wrong_type(bench, seed);
  const Window& window = wrong.scenario.window;
  const Trace trace = play(bench, wrong.scenario);
  RunResult result = judge(trace, bench.reference, window, true);
  int events = 0;
  for (const EventNote& event : trace.events) {
    if (event.reason.find(wrong.channel) == std::string::npos ||
        event.reason.find(hexadecimal(wrong.fingerprint)) == std::string::npos)
      continue;
    if (events++ == 0)
      result.measured = 1e3 * (1e-9 * static_cast<double>(event.time_ns) - window.begin);
  }
  if (events == 0) result.fail("no event names channel and fingerprint");
  if (events > 2) result.fail("more than one event a second: " + std::to_string(events));
  return result;
}

}  // namespace

std::vector<Row> message_rows() {
  return {
      loss(0.10, "error of shape grows by at most 5 %", 5),
      loss(0.20, "error of shape grows by at most 15 %", 15),
      loss(0.50, "continues", kNone),
      scenario_row({"1", "bursts of up to 20 ms", "no change of state", "changes", 0, false, {}},
                   bursts, judge_bursts),
      scenario_row({"2",
                    "order, 1 to 16 places",
                    "as if the late ones were lost, to the bit",
                    "cycles",
                    0,
                    false,
                    {}},
                   disorder, judge_disorder),
      scenario_row(
          {"3", "duplicates, x2 to x100", "none the worse, to the bit", "cycles", 0, false, {}},
          duplicates, judge_duplicates),
      {"10", "wrong fingerprint", "event with channel and both types within 100 ms, 1/s", "ms", 100,
       false, run_wrong_type,
       [](const Bench& bench, std::uint64_t seed) { return wrong_type(bench, seed).scenario; }},
  };
}

}  // namespace palpate::faults
