#include <algorithm>
#include <chrono>
#include <iterator>

#include "rt/config/command_line.hpp"
#include "rt/config/node.hpp"
#include "tools/lab/faults/palpated_run.hpp"
#include "tools/lab/faults/rows_plugins.hpp"

namespace palpate::faults {
namespace {

constexpr int kAttempts = 5;       // other programs may take the processor
constexpr double kZeroAfter = 20;  // ms, of a hang

const unruly::Slot& any_slot(math::Random& random) {
  return unruly::kSlots[random.below(std::size(unruly::kSlots))];
}

RunResult run_palpated_error(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "plug-in errs");
  const unruly::Slot& slot = any_slot(random);
  const char* does = unruly::kErrors[random.below(std::size(unruly::kErrors))];
  const bool fallback = random.below(2) == 0;
  const PalpatedRun run = run_palpated(bench, plugin_scenario(bench, slot, does, fallback, random));
  RunResult result;
  if (!run.alive || run.exit_code != 0) {
    result.crashed = true;
    result.fail("palpated ended with exit code " + std::to_string(run.exit_code) + ": " +
                run.words);
  } else {
    result = judge_plugin_error(run.trace, fallback);
  }
  if (result.has_miss()) result.append(std::string("; ") + slot.component + " does " + does);
  return result;
}

RunResult run_palpated_hang(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "plug-in hangs");
  const unruly::Slot& slot = any_slot(random);
  const bool fallback = random.below(2) == 0;  // serves errors, and cannot help here
  const Scenario scenario = plugin_scenario(bench, slot, "hang", fallback, random);
  RunResult result;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const PalpatedRun run = run_palpated(bench, scenario);
    if (run.alive || run.exit_code != config::kExitHung ||
        run.words.find(slot.component) == std::string::npos)
      result.fail(std::string(slot.component) + ": exit code " + std::to_string(run.exit_code) +
                  ": " + run.words);
    const Cycle& last = run.trace.cycles.back();
    if (last.command_valid || last.speed != 0) result.fail("the last command is not zero");
    // The watchdog's zero, the last command, is not limited in acceleration.
    if (run.trace.not_finite + run.trace.undecoded > 0 || run.trace.beyond_limits > 1)
      result.fail(run.trace.complaint);
    const double zero = 1e3 * run.last_gap;
    result.measured = attempt == 0 ? zero : std::min(zero, result.measured);
    if (result.measured <= kZeroAfter || result.has_miss()) break;
  }
  result.outcome = std::max(result.outcome, Outcome::kSafeStop);
  return result;
}

/// At the start: construction, configuration or warm-up throws or does not return.
RunResult run_palpated_setup(const Bench&, std::uint64_t seed) {
  constexpr double kPatience = 40;  // s
  math::Random random(seed, "plug-in fails at set-up");
  const unruly::Slot& slot = any_slot(random);
  const char* does = unruly::kSetupErrors[random.below(std::size(unruly::kSetupErrors))];
  const common::TemporaryFolder folder("palpate-faults");
  const auto begin = std::chrono::steady_clock::now();
  common::Process daemon =
      start_palpated(configuration({unruly::kLibrary, slot.configured(does, "")}),
                     runs::private_urls(), folder.path());
  const std::optional<int> code = daemon.wait(kPatience);
  RunResult result;
  result.measured = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  result.outcome = Outcome::kSafeStop;
  const std::string words = common::tail(daemon.output(), 1);
  if (code != config::kExitCode || words.find(slot.component) == std::string::npos)
    result.fail(std::string(slot.component) + " does " + does + ": exit code " +
                std::to_string(code.value_or(-1)) + ": " + words);
  return result;
}

}  // namespace

std::vector<Row> plugin_process_rows() {
  return {{"26", "plug-in errs, with or without fallback",
           "the fallback commands, or zero command, in 100 ms; reported", "ms", 100, false,
           run_palpated_error},
          {"26", "plug-in hangs in the loop", "zero command in 20 ms, then exit code 5", "ms",
           kZeroAfter, false, run_palpated_hang},
          {"26", "plug-in throws or hangs at set-up", "exit code 78 that names it, in 5 s", "s", 5,
           false, run_palpated_setup}};
}

}  // namespace palpate::faults
