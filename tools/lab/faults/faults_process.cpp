#include "tools/lab/faults/faults_process.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <functional>
#include <palpate/channels.hpp>
#include <stdexcept>

#include "rt/config/installation.hpp"
#include "tools/common/interruption.hpp"
#include "tools/common/process.hpp"
#include "tools/lab/faults/campaign.hpp"
#include "tools/lab/faults/fault_wire.hpp"
#include "tools/lab/faults/judge.hpp"
#include "tools/lab/faults/mutation.hpp"
#include "tools/lab/faults/palpated_run.hpp"
#include "tools/lab/faults/process_judge.hpp"
#include "tools/lab/faults/rows_plugins.hpp"

namespace palpate::faults {
namespace {

constexpr double kProcessPatience = 20;  // s, until a process publishes its first message
constexpr double kLatestSend = 0.1;      // s, of a message being sent
constexpr double kRunsBy = 0.2;          // s of a scenario
constexpr int kConfigurationErrors = 5;
constexpr int kExitConfiguration = 78;

/// Empty if the daemon was not active before the fault, or if this machine stalled so long that the
/// scenario was a different one.
std::optional<RunResult> play_once(const Bench& bench, const Scenario& scenario, bool& late) {
  const PalpatedRun run = run_palpated(bench, scenario);
  if (!run.alive || run.exit_code != 0) {
    RunResult result;
    result.crashed = true;
    result.fail("palpated ended with exit code " + std::to_string(run.exit_code) + ": " +
                run.words);
    return result;
  }
  late = run.latest > kLatestSend;
  if (late) return std::nullopt;
  if (!has_run(run.trace, std::max(scenario.window.begin, kRunsBy))) return std::nullopt;
  return judge_process(run.trace, play(bench, scenario), bench, scenario);
}

/// If the machine stalls while the daemon starts, the run is inconclusive: repeat it.
RunResult play_to_process(const Bench& bench, const Scenario& scenario) {
  bool late = false;
  for (int attempt = 0; attempt < 5; ++attempt)
    if (const auto result = play_once(bench, scenario, late)) return *result;
  RunResult result;
  result.fail(late ? kNotPlayed : "palpated does not run after the command to start");
  return result;
}

/// A single configuration: rejected with exit code 78 and the location, or accepted if it is valid
/// after all.
void reject_one(math::Random& random, RunResult& result) {
  const common::TemporaryFolder folder("palpate-faults");
  const runs::Urls urls = runs::private_urls();
  Mutation mutation;
  do {  // without its own ports the daemon would receive other programs' messages
    mutation = mutate_configuration(
        random, {"bus.control=" + urls.control, "bus.housekeeping=" + urls.housekeeping});
  } while (mutation.key == "control" || mutation.key == "housekeeping" || mutation.key == "bus");
  const std::filesystem::path file = folder.path() / "mutated.yaml";
  write_text(file, mutation.text);
  const FaultWire wire(urls);
  common::Process daemon(
      "palpated", {(common::program_folder() / "palpated").string(), "--config", file.string()},
      folder.path() / "palpated.txt");
  for (double waited = 0; !wire.heard() && daemon.running() && waited < kProcessPatience;
       waited += 0.01)
    common::sleep_for(0.01);
  const std::string where = mutation.what + " " + mutation.key + ": ";
  if (daemon.running()) {
    if (mutation.must_fail) result.fail(where + "is taken");
    if (daemon.stop() != 0) result.fail(where + "does not end well");
    return;
  }
  const int code = daemon.wait(0).value_or(-1);
  const std::string words = common::tail(daemon.output(), 5);
  if (code != kExitConfiguration)
    result.fail(where + "exit code " + std::to_string(code) + ": " + words);
  result.outcome = std::max(result.outcome, Outcome::kSafeStop);
  if (names_its_place(mutation, words)) return;
  ++result.measured;
  result.note(where + words);
}

RunResult reject_configurations(const Bench&, std::uint64_t seed) {
  math::Random random(seed, "configuration of a process");
  RunResult result;
  result.measured = 0;
  for (int i = 0; i < kConfigurationErrors; ++i) reject_one(random, result);
  return result;
}

constexpr double kSimulatorPatience = 40;  // s; the plant settles first
constexpr double kBraked = 0.5;            // s after which all motion must have ended

common::Process start_simulator(const runs::Urls& urls, const std::filesystem::path& folder,
                                const char* words) {
  return {"palpate-sim",
          {(common::program_folder() / "palpate-sim").string(),
           (config::data_folder() / "sim/scenes/bar_long_soft_control.yaml").string(), "--set",
           "object.elements=[8, 1, 1]", "--set", "bus.control=" + urls.control, "--set",
           "bus.housekeeping=" + urls.housekeeping, "--set", "bus.pictures=" + urls.pictures},
          folder / words};
}

/// False if the condition is not met in time.
bool wait_until(client::Client& user, const std::function<bool()>& condition) {
  return user.wait(kSimulatorPatience, [&] {
    common::throw_if_interrupted();
    return condition();
  });
}

bool starts(client::Client& user) {
  constexpr std::int64_t kRepeat = 500'000;  // us
  return wait_until(user, [&, next = std::int64_t{0}]() mutable {
    if (const std::int64_t now = bus::wall_clock_us(); now >= next) {
      user.send({"start"}, now);
      next = now + kRepeat;
    }
    return user.is_active();
  });
}

RunResult kill_simulator(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "simulator killed");
  const common::TemporaryFolder folder("palpate-faults");
  const runs::Urls urls = runs::private_urls();
  const config::Node root = configuration(patient({}));
  FaultWire wire(urls);
  common::Process daemon = start_palpated(root, urls, folder.path());
  RunResult result;
  const auto control = bus::make_lcm_bus(urls.control),
             housekeeping = bus::make_lcm_bus(urls.housekeeping);
  client::Client user(*control, *housekeeping);
  user.wait(0);  // from now on messages are received
  double killed = 0, again = 0;
  {
    const common::Process simulator = start_simulator(urls, folder.path(), "simulator.txt");
    if (!wait_until(user, [&] { return user.received(channel::kRobotState) > 0; })) {
      result.fail("no simulator: " + common::tail(folder.path() / "simulator.txt", 1));
      return result;
    }
    wire.begin();
    if (!starts(user)) result.fail("does not become active");
    user.set_target(message_of(bench.recording.target), bus::wall_clock_us());
    user.wait(0.3 + random.uniform(0, 0.5));
    killed = wire.now();
    kill(simulator.pid(), SIGKILL);
    user.wait(random.uniform(0, 0.5));
  }
  const common::Process simulator = start_simulator(urls, folder.path(), "simulator_again.txt");
  const auto inactive = [&] { return user.health()->state == health_t::STATE_INACTIVE; };
  if (!wait_until(user, inactive)) result.fail("is not inactive with a new simulator");
  user.wait(0.5);
  again = wire.now();
  if (!starts(user)) result.fail("does not become active again");

  const int ticks = static_cast<int>(wire.now() * 1e3);
  const Trace trace = wire.trace(ticks, registry::read_gate_limits(root), kTick);
  if (const int code = daemon.stop(); code != 0) {
    result.crashed = true;
    result.fail("palpated ended with exit code " + std::to_string(code));
  }
  const RunResult whole = judge_alone(trace, {killed, again});
  if (!result.has_miss()) result = whole;
  const double zero = zero_after(trace, killed, again);
  if (zero < 0 || zero > kBraked) result.fail("moves without a simulator, or before start");
  result.measured = 1e3 * zero;
  return result;
}

/// palpate-sim, running with palpated, is killed while the loop is closed, and restarted.
Row killed_simulator_row() {
  return {"19",
          "simulator killed, started again",
          "zero command in 100 ms, inactive until start",
          "ms",
          100,
          false,
          kill_simulator};
}

}  // namespace

std::vector<Row> process_rows() {
  constexpr double kLater = 200;  // ms
  std::vector<Row> rows;
  for (const Row& row : all_rows()) {
    if (row.number == "21") {
      rows.push_back(
          {row.number, std::to_string(kConfigurationErrors) + " errors in the configuration",
           "exit code 78 with file, line and key", "unnamed", 0, false, reject_configurations});
    }
    if (!row.scenario) continue;
    Row process{row.number,
                row.fault,
                "taken as in virtual time, reported 200 ms later at most",
                "ms later",
                kLater,
                false,
                [make = row.scenario](const Bench& bench, std::uint64_t seed) {
                  return play_to_process(bench, make(bench, seed));
                }};
    rows.push_back(process);
    if (row.number == "19") rows.push_back(killed_simulator_row());
  }
  for (const Row& row : plugin_process_rows()) rows.push_back(row);
  return rows;
}

std::vector<Row> choose_process_rows(const std::vector<std::string>& numbers) {
  return choose_rows(process_rows(), numbers);
}

}  // namespace palpate::faults
