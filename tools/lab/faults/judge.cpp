#include "tools/lab/faults/judge.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::faults {
namespace {

using pipeline::LifeCycle;

constexpr int kRecordedTicks = 1900;

int index_of(double seconds) { return static_cast<int>(std::lround(seconds / kTick)) - 1; }
double time_of(int index) { return kTick * (index + 1); }
double since(std::int64_t time_ns, double from) {
  return 1e-9 * static_cast<double>(time_ns) - from;
}

bool differs(const HealthNote& a, const HealthNote& b) {
  constexpr double kSlack = 2;  // ms
  return a.state != b.state || a.lost != b.lost || a.rejected != b.rejected ||
         a.frozen != b.frozen || a.not_converged > b.not_converged + 10 ||
         a.gate_rejected != b.gate_rejected || a.overruns != b.overruns ||
         a.oldest_ms > b.oldest_ms + kSlack || a.hand_ms > b.hand_ms + kSlack;
}

}  // namespace

Bench make_bench() {
  Bench bench;
  bench.recording = record_loop(kRecordedTicks);
  bench.reference = Replay(bench.recording).run(bench.recording.stream, kRecordedTicks);
  const Trace& reference = bench.reference;
  if (!reference.sound())
    throw std::runtime_error("the fault-free run is not sound: " + reference.complaint);
  for (const EventNote& event : reference.events)
    if (event.event == "jump") throw std::runtime_error("the shape of the fault-free run jumps");
  for (double t = 0.2; t < time_of(kRecordedTicks - 1); t += 0.05) {
    const Cycle& cycle = reference.cycles[index_of(t)];
    if (cycle.state != LifeCycle::kActive || !(cycle.speed > 1e-3))
      throw std::runtime_error("the fault-free run stands still at " + std::to_string(t) + " s");
  }
  return bench;
}

double visible_after(const Trace& trace, const Trace& reference, double from) {
  double first = -1;
  const auto seen = [&](std::int64_t time_ns) {
    const double t = since(time_ns, from);
    if (t >= -0.5 * kTick && (first < 0 || t < first)) first = std::max(0.0, t);
  };
  auto same_time = reference.health.begin();
  for (const HealthNote& note : trace.health) {
    while (same_time != reference.health.end() && same_time->time_ns < note.time_ns) ++same_time;
    if (same_time == reference.health.end()) break;
    // An output outside the schedule has a cause, such as the fault.
    if (same_time->time_ns != note.time_ns || differs(note, *same_time)) seen(note.time_ns);
  }
  for (const EventNote& event : trace.events) {
    const bool expected =
        std::any_of(reference.events.begin(), reference.events.end(), [&](const EventNote& other) {
          return other.time_ns == event.time_ns && other.event == event.event;
        });
    if (!expected) seen(event.time_ns);
  }
  return first;
}

double inactive_after(const Trace& trace, double from, double until) {
  const int end = std::min<int>(index_of(until), static_cast<int>(trace.cycles.size()));
  for (int i = index_of(from); i < end; ++i)
    if (trace.cycles[i].state != LifeCycle::kActive) return std::max(0.0, time_of(i) - from);
  return -1;
}

double active_again_after(const Trace& trace, double from) {
  int first = static_cast<int>(trace.cycles.size());
  while (first > 0 && trace.cycles[first - 1].state == LifeCycle::kActive) --first;
  if (first == static_cast<int>(trace.cycles.size())) return -1;
  return std::max(0.0, time_of(first) - from);
}

double zero_after(const Trace& trace, double from, double until) {
  int first = std::min<int>(index_of(until), static_cast<int>(trace.cycles.size()));
  const int end = first;
  while (first > 0 && trace.cycles[first - 1].speed == 0) --first;
  return first == end ? -1 : std::max(0.0, time_of(first) - from);
}

int different_cycles(const Trace& trace, const Trace& reference, bool contacts) {
  int count = 0;
  const std::size_t cycles = std::min(trace.cycles.size(), reference.cycles.size());
  for (std::size_t i = 0; i < cycles; ++i) {
    const Cycle &a = trace.cycles[i], &b = reference.cycles[i];
    count += a.hash != b.hash || (contacts && a.contact_hash != b.contact_hash) ? 1 : 0;
  }
  return count;
}

double shape_rmse(const Trace& trace, const Window& window) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < trace.shape_error.size(); ++i) {
    if (!window.holds(static_cast<std::int64_t>(i + 1) * kTruthEvery * 1'000'000)) continue;
    sum += trace.shape_error[i] * trace.shape_error[i];
    ++count;
  }
  return count == 0 ? -1 : std::sqrt(sum / count);
}

double first_difference(const Stream& faulted, const Stream& good) {
  for (std::size_t i = 0; i < std::min(faulted.size(), good.size()); ++i) {
    const bus::Published &a = faulted[i], &b = good[i];
    if (a.time_ns != b.time_ns || a.channel != b.channel || a.data != b.data)
      return 1e-9 * static_cast<double>(std::min(a.time_ns, b.time_ns));
  }
  return 1e-9 * static_cast<double>(good.back().time_ns);
}

RunResult outcome_of(const Trace& trace, const Window& window) {
  RunResult result;
  result.detected = inactive_after(trace, window.begin, time_of(1 << 20));
  if (result.detected >= 0) {
    result.outcome = Outcome::kDegraded;
    result.recovered = active_again_after(trace, window.end);
    for (std::size_t i = index_of(window.begin); i < trace.cycles.size(); ++i) {
      const LifeCycle state = trace.cycles[i].state;
      if (state != LifeCycle::kActive && state != LifeCycle::kDegraded)
        result.outcome = Outcome::kSafeStop;
    }
  }
  const auto rejected = [](const Trace& t) {
    return t.health.empty() ? 0 : t.health.back().gate_rejected;
  };
  // The gate restrains the command although every component reports ok.
  if (rejected(trace) > 0 && result.outcome == Outcome::kUnaffected)
    result.outcome = Outcome::kDegraded;
  if (!trace.sound()) result.fail(trace.complaint);
  return result;
}

RunResult judge(const Trace& trace, const Trace& reference, const Window& window, bool must_show) {
  RunResult result = outcome_of(trace, window);
  result.visible = visible_after(trace, reference, window.begin);
  const bool shows =
      result.visible >= 0 && result.visible <= kVisibleWithin + kNextMessage + 0.5 * kTick;
  const bool harmed = result.outcome != Outcome::kUnaffected;
  if (harmed && result.visible < 0) result.fail("silent: neither HEALTH nor an event reports it");
  if (must_show && !shows)
    result.fail(result.visible < 0
                    ? "silent: neither HEALTH nor an event reports it"
                    : "HEALTH reports it after " + std::to_string(1e3 * result.visible) + " ms");
  return result;
}

}  // namespace palpate::faults
