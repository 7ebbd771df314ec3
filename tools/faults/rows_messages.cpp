// Messages lost, late, doubled, of another type.

#include <palpate/ft_wrench_t.hpp>

#include "tools/faults/rows.hpp"
#include "tools/faults/transforms.hpp"

namespace palpate::faults {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Fault from 0.25 s on, half a second or as said, and time to recover.
constexpr Window kWindow{0.25, 0.75};
constexpr int kTicks = 900;

/// The window from where the stream first differs.
Window from_first(const Stream& faulted, const Bench& bench, const Window& window) {
  return {first_difference(faulted, bench.recording.stream), window.end};
}

RunResult judge_error(const Bench& bench, const Stream& faulted) {
  const Trace trace = Replay(bench.recording).run(faulted, kTicks);
  RunResult result = judge(trace, bench.reference, from_first(faulted, bench, kWindow), true);
  const double before = shape_rmse(bench.reference, kWindow);
  result.measured = std::max(0.0, 100 * (shape_rmse(trace, kWindow) / before - 1));
  return result;
}

Row loss(double probability, const char* figure, double limit) {
  Row row{"1",    "loss " + std::to_string(std::lround(100 * probability)) + " %",
          figure, "%",
          limit,  false,
          {}};
  row.run = [probability](const Bench& bench, std::uint64_t seed) {
    math::Random random(seed, "loss");
    return judge_error(bench,
                       lose(bench.recording.stream, sensors_in(kWindow), probability, random));
  };
  return row;
}

RunResult run_bursts(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "bursts");
  const Stream faulted = lose_bursts(bench.recording.stream, kWindow, 0.020, random);
  const Trace trace = Replay(bench.recording).run(faulted, kTicks);
  RunResult result = judge(trace, bench.reference, from_first(faulted, bench, kWindow), true);
  result.measured = 0;
  for (const EventNote& event : trace.events)
    if (event.event == "degraded" && event.time_ns > 250'000'000) {
      ++result.measured;
      result.note(event.reason);
    }
  return result;
}

RunResult run_reorder(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "reorder");
  const int reach = 1 + static_cast<int>(random.below(16));
  const Stream faulted = reorder(bench.recording.stream, sensors_in(kWindow), reach, random);
  const Trace trace = Replay(bench.recording).run(faulted, kTicks);
  const Trace kept = Replay(bench.recording).run(rising(faulted), kTicks);
  RunResult result = judge(trace, bench.reference, from_first(faulted, bench, kWindow), true);
  result.measured = different_cycles(trace, kept, true);
  return result;
}

RunResult run_duplicates(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "duplicates");
  const int most = 2 + static_cast<int>(random.below(99));
  const Stream faulted = duplicate(bench.recording.stream, sensors_in(kWindow), most, random);
  const Trace trace = Replay(bench.recording).run(faulted, kTicks);
  RunResult result = judge(trace, bench.reference, from_first(faulted, bench, kWindow), true);
  result.measured = different_cycles(trace, bench.reference, true);
  return result;
}

std::string hexadecimal(std::int64_t number) {
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(number));
  return text;
}

RunResult run_wrong_type(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "type");
  constexpr const char* kChannels[] = {"FT_WRENCH", "IMU", "ROBOT_STATE", "HAND_STATE"};
  const std::string channel = kChannels[random.below(4)];
  const auto wrong = static_cast<std::int64_t>(random.next());
  const double share = random.uniform() < 0.5 ? 1.0 : random.uniform(0.1, 1.0);
  const Window window{0.25 + random.uniform(0, 0.1), 1.5};
  math::Random draws = random.split("draws");
  const Which in_window = sensors_in(window, channel);
  const Stream faulted = change_type(
      bench.recording.stream,
      [&](const bus::Published& m) { return in_window(m) && draws.uniform() < share; }, wrong);
  const Trace trace = Replay(bench.recording).run(faulted, 1700);
  const Window from = from_first(faulted, bench, window);
  RunResult result = judge(trace, bench.reference, from, true);

  int events = 0;
  for (const EventNote& event : trace.events) {
    if (event.reason.find(channel) == std::string::npos ||
        event.reason.find(hexadecimal(wrong)) == std::string::npos)
      continue;
    if (events++ == 0)
      result.measured = 1e3 * (1e-9 * static_cast<double>(event.time_ns) - from.begin);
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
      loss(0.50, "goes on", kNone),
      {"1", "bursts of up to 20 ms", "no change of state", "changes", 0, false, run_bursts},
      {"2", "order, 1 to 16 places", "as if the late ones were lost, to the bit", "cycles", 0,
       false, run_reorder},
      {"3", "duplicates, x2 to x100", "none the worse, to the bit", "cycles", 0, false,
       run_duplicates},
      {"10", "wrong fingerprint", "event with channel and both types within 100 ms, 1/s", "ms", 100,
       false, run_wrong_type},
  };
}

}  // namespace palpate::faults
