#include "tools/lab/faults/process_judge.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::faults {
namespace {

using pipeline::LifeCycle;

bool is_news(const HealthNote& note, const HealthNote& before) {
  constexpr double kOlder = 50;  // ms, in addition to the delays of a busy machine
  constexpr int kSteps = 10;
  return note.state != before.state || note.lost != before.lost ||
         note.rejected != before.rejected || note.frozen != before.frozen ||
         note.gate_rejected != before.gate_rejected ||
         note.not_converged > before.not_converged + kSteps ||
         note.oldest_ms > before.oldest_ms + kOlder || note.hand_ms > before.hand_ms + kOlder;
}

double time_of(std::int64_t time_ns) { return 1e-9 * static_cast<double>(time_ns); }

std::size_t index_of(double seconds, const Trace& trace) {
  const auto index = static_cast<std::size_t>(std::max(0L, std::lround(seconds / kTick) - 1));
  return std::min(index, trace.cycles.size() - 1);
}

bool any_state(const Trace& trace, double from, double until, LifeCycle state) {
  for (std::size_t i = index_of(from, trace); i <= index_of(until, trace); ++i)
    if (trace.cycles[i].state == state) return true;
  return false;
}

/// Cycles were late in the second before `end`: then palpated may correctly report that it is
/// degraded, regardless of the fault.
bool runs_late(const Trace& trace, double end) {
  std::int64_t before = -1, last = -1;
  for (const HealthNote& note : trace.health) {
    last = note.overruns;
    if (before < 0 || time_of(note.time_ns) < end - 1) before = note.overruns;
  }
  return last > before;
}

/// The state is known from HEALTH, which the commands of the same cycle precede: only lasting
/// violations count.
int longest_command_while_inactive(const Trace& trace) {
  int inactive = 0, commands = 0, longest = 0;
  for (const Cycle& cycle : trace.cycles) {
    inactive = cycle.state == LifeCycle::kInactive ? inactive + 1 : 0;
    const bool braked = inactive > 1e3 * kZeroWithin;
    commands =
        cycle.state == LifeCycle::kInactive && (cycle.command_valid || (braked && cycle.speed > 0))
            ? commands + 1
            : 0;
    longest = std::max(longest, commands);
  }
  return longest;
}

}  // namespace

double reported_after(const Trace& trace, double from) {
  HealthNote before;
  double first = -1;
  for (const HealthNote& note : trace.health) {
    if (time_of(note.time_ns) < from) {
      before = note;
    } else if (is_news(note, before)) {
      first = time_of(note.time_ns) - from;
      break;
    }
  }
  for (const EventNote& event : trace.events) {
    const double t = time_of(event.time_ns) - from;
    if (t >= 0 && (first < 0 || t < first)) first = t;
  }
  return first;
}

bool has_run(const Trace& trace, double time) {
  return any_state(trace, 0, time, LifeCycle::kActive) ||
         any_state(trace, 0, time, LifeCycle::kDegraded);
}

RunResult judge_alone(const Trace& trace, const Window& window) {
  RunResult result = outcome_of(trace, window);
  result.visible = reported_after(trace, window.begin);
  constexpr int kLasts = 50;  // ms
  if (const int longest = longest_command_while_inactive(trace); longest > kLasts)
    result.fail("commands of " + std::to_string(longest) + " ms while it is inactive");
  if (result.outcome != Outcome::kUnaffected && result.visible < 0)
    result.fail("silent: neither HEALTH nor an event reports it");
  return result;
}

RunResult judge_process(const Trace& trace, const Trace& expected, const Bench& bench,
                        const Scenario& scenario) {
  const Window& window = scenario.window;
  const double end = kTick * scenario.ticks;
  const RunResult wanted = judge(expected, bench.reference, window, false);
  RunResult result = judge_alone(trace, window);
  const bool shows = wanted.visible >= 0;
  if (shows && result.visible < 0) result.fail("silent: neither HEALTH nor an event reports it");
  if (shows) result.measured = 1e3 * std::max(0.0, result.visible - wanted.visible);

  const double zero = zero_after(expected, window.begin, window.end);
  if (zero >= 0 && zero_after(trace, window.begin, window.end) < 0)
    result.fail("the command does not come to zero");
  const LifeCycle last = expected.cycles.back().state;
  const double back = std::max(window.end, end - 0.3);
  const bool may_recover = window.end < end || wanted.outcome == Outcome::kUnaffected;
  const bool excused = last == LifeCycle::kActive && runs_late(trace, end) &&
                       trace.cycles.back().state == LifeCycle::kDegraded;
  if (may_recover && !excused && !any_state(trace, std::min(back, end), end, last))
    result.fail(std::string("ends ") + pipeline::name(trace.cycles.back().state) + ", not " +
                pipeline::name(last));
  return result;
}

}  // namespace palpate::faults
