#include "tools/lab/faults/rows_plugins.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "tools/lab/faults/process_judge.hpp"

namespace palpate::faults {
namespace {

using pipeline::LifeCycle;

constexpr int kPluginTicks = 900;

RunResult run_error(const Bench& bench, std::uint64_t seed, bool fallback) {
  math::Random random(seed, "plug-in errs");
  const unruly::Slot& slot = unruly::kSlots[random.below(std::size(unruly::kSlots))];
  const char* does = unruly::kErrors[random.below(std::size(unruly::kErrors))];
  const Scenario scenario = plugin_scenario(bench, slot, does, fallback, random);
  RunResult result = judge_plugin_error(play(bench, scenario), fallback);
  if (result.has_miss()) result.append(std::string("; ") + slot.component + " does " + does);
  return result;
}

}  // namespace

Scenario plugin_scenario(const Bench& bench, const unruly::Slot& slot, const std::string& does,
                         bool fallback, math::Random& random) {
  Scenario scenario;
  const int after = 200 + static_cast<int>(random.below(200));  // calls of the component
  scenario.overrides = {
      unruly::kLibrary,
      slot.configured(does, ", after: " + std::to_string(after) +
                                (fallback ? std::string(", fallback: ") + slot.fallback : ""))};
  // The rigid model has no sensitivities: the others do not depend on them.
  if (std::string_view(slot.name) == "deformation") {
    scenario.overrides.emplace_back("estimation={component: pose_driven}");
    scenario.overrides.emplace_back("control={provider: kinematic, law: proportional_twist}");
  }
  scenario.stream = bench.recording.stream;
  scenario.ticks = kPluginTicks;
  scenario.window = {1e-3 * kTargetTick, 1e-3 * kPluginTicks};
  return scenario;
}

RunResult judge_plugin_error(const Trace& trace, bool fallback) {
  const auto time_of = [](int cycle) { return kTick * (cycle + 1); };
  const int cycles = static_cast<int>(trace.cycles.size());
  int fault = kTargetTick;
  while (fault < cycles && trace.cycles[fault].state != LifeCycle::kActive) ++fault;
  while (fault < cycles && trace.cycles[fault].state == LifeCycle::kActive) ++fault;
  RunResult result;
  if (fault == cycles) {
    result.fail("was never active, or the error has no effect");
    return result;
  }
  const Window window{time_of(fault), time_of(cycles)};
  // Of a process the state is known from HEALTH, which the event may precede.
  constexpr double kHealthPeriod = 0.1;  // s
  result = judge_alone(trace, {window.begin - kHealthPeriod, window.end});
  const Cycle& last = trace.cycles.back();
  if (fallback) {
    int still = fault;  // the first cycle from which on it commands
    for (int i = fault; i < cycles; ++i)
      if (trace.cycles[i].speed == 0) still = i + 1;
    if (result.outcome != Outcome::kDegraded)
      result.fail(std::string("ends ") + pipeline::name(last.state) + " in spite of its fallback");
    if (still == cycles || !last.command_valid) result.fail("the fallback does not command");
    result.measured = 1e3 * kTick * (still - fault);
    return result;
  }
  if (last.state == LifeCycle::kActive) result.fail("is active with an error");
  const double zero = zero_after(trace, window.begin, window.end);
  if (zero < 0) result.fail("the command does not come to zero");
  result.outcome = std::max(result.outcome, Outcome::kSafeStop);
  result.measured = 1e3 * zero;
  return result;
}

std::vector<Row> plugin_rows() {
  const auto row = [](bool fallback) {
    return Row{"26",
               std::string("plug-in errs") + (fallback ? ", with fallback" : ""),
               fallback ? "the fallback commands within 100 ms, reported"
                        : "zero command in 100 ms, kept, reported",
               "ms",
               100,
               false,
               [fallback](const Bench& bench, std::uint64_t seed) {
                 return run_error(bench, seed, fallback);
               }};
  };
  return {row(false), row(true)};
}

}  // namespace palpate::faults
