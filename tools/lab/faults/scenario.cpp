#include "tools/lab/faults/scenario.hpp"

#include <utility>

namespace palpate::faults {

Trace play(const Bench& bench, const Scenario& scenario) {
  const Scenario::Held& held = scenario.held;
  Replay replay(bench.recording, scenario.overrides,
                held.length > 0 ? daemon::Mode::kRealTime : daemon::Mode::kDeterministic);
  return replay.run(scenario.stream, scenario.ticks, [&](int tick, daemon::Now& now) {
    if (tick >= held.tick && tick < held.tick + held.length) return false;
    if (held.length > 0 && tick == held.tick + held.length)
      now.lateness_ns = 1'000'000LL * held.length;
    for (const Scenario::Act& act : scenario.acts)
      if (act.tick == tick) act.act(replay.user());
    if (scenario.clock_offset) now.utime += scenario.clock_offset(now.monotonic_ns);
    return true;
  });
}

Row scenario_row(Row row, std::function<Scenario(const Bench&, std::uint64_t seed)> make,
                 std::function<RunResult(const Bench&, const Scenario&)> judge) {
  row.scenario = std::move(make);
  row.run = [make = row.scenario, judge = std::move(judge)](
                const Bench& bench, std::uint64_t seed) { return judge(bench, make(bench, seed)); };
  return row;
}

Window from_first(const Stream& faulted, const Bench& bench, const Window& window) {
  return {first_difference(faulted, bench.recording.stream), window.end};
}

}  // namespace palpate::faults
