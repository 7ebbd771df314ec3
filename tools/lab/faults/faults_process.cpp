#include "tools/lab/faults/faults_process.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <stdexcept>

#include "tools/common/interruption.hpp"
#include "tools/common/process.hpp"
#include "tools/lab/faults/campaign.hpp"
#include "tools/lab/faults/fault_wire.hpp"
#include "tools/lab/faults/faults_simulator.hpp"
#include "tools/lab/faults/mutation.hpp"
#include "tools/lab/faults/process_judge.hpp"

namespace palpate::faults {
namespace {

using faults::Bench;
using faults::Row;
using faults::RunResult;
using faults::Scenario;

constexpr double kPatience = 20;  // s, until a process publishes its first message
constexpr double kLatest = 0.1;   // s, of a message being sent
constexpr double kRunsBy = 0.2;   // s of a scenario
constexpr int kConfigurationErrors = 5;
constexpr int kExitConfiguration = 78;

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text << '\n';
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

/// Empty if the daemon was not active before the fault, or if this machine stalled so long that the
/// scenario was a different one.
std::optional<RunResult> play_once(const Bench& bench, const Scenario& scenario, bool& late) {
  const FaultFolder folder;
  const runs::Urls urls = runs::private_urls();
  const std::vector<std::string> overrides =
      scenario.held.length > 0 ? scenario.overrides : patient(scenario.overrides);
  const config::Node root = faults::configuration(overrides);
  FaultWire wire(urls);
  common::Process daemon = start_palpated(root, urls, folder.path());
  for (double waited = 0; !wire.heard() && daemon.running() && waited < kPatience; waited += 0.01)
    common::sleep_for(0.01);

  wire.play(bench.recording, scenario, [&](int tick) {
    if (scenario.held.length == 0) return;
    if (tick == scenario.held.tick) kill(daemon.pid(), SIGSTOP);
    if (tick == scenario.held.tick + scenario.held.length) kill(daemon.pid(), SIGCONT);
  });
  const bool alive = daemon.running();
  const faults::Trace trace =
      wire.trace(scenario.ticks, registry::read_gate_limits(root), faults::kTick);
  const int code = daemon.stop();
  if (!alive || code != 0) {
    RunResult result;
    result.crashed = true;
    result.fail("palpated ended with exit code " + std::to_string(code) + ": " +
                common::tail(daemon.output(), 1));
    return result;
  }
  late = wire.latest() > kLatest;
  if (late) return std::nullopt;
  if (!has_run(trace, std::max(scenario.window.begin, kRunsBy))) return std::nullopt;
  return judge_process(trace, play(bench, scenario), bench, scenario);
}

/// If the machine stalls while the daemon starts, the run is inconclusive: repeat it.
RunResult play_to_process(const Bench& bench, const Scenario& scenario) {
  bool late = false;
  for (int attempt = 0; attempt < 5; ++attempt)
    if (const auto result = play_once(bench, scenario, late)) return *result;
  RunResult result;
  result.fail(late ? kNotPlayed : "palpated does not run when it is told to start");
  return result;
}

/// A single configuration: rejected with exit code 78 and the location, or accepted if it is valid
/// after all.
void refuse_one(math::Random& random, RunResult& result) {
  const FaultFolder folder;
  const runs::Urls urls = runs::private_urls();
  faults::Mutation mutation;
  do {  // without its own ports the daemon would receive other programs' messages
    mutation = faults::mutate_configuration(
        random, {"bus.control=" + urls.control, "bus.housekeeping=" + urls.housekeeping});
  } while (mutation.key == "control" || mutation.key == "housekeeping" || mutation.key == "bus");
  const std::filesystem::path file = folder.path() / "mutated.yaml";
  write_text(file, mutation.text);
  const FaultWire wire(urls);
  common::Process daemon(
      "palpated", {(common::program_folder() / "palpated").string(), "--config", file.string()},
      folder.path() / "palpated.txt");
  for (double waited = 0; !wire.heard() && daemon.running() && waited < kPatience; waited += 0.01)
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
  result.outcome = std::max(result.outcome, faults::Outcome::kSafeStop);
  if (names_its_place(mutation, words)) return;
  ++result.measured;
  result.note(where + words);
}

RunResult refuse_configurations(const Bench&, std::uint64_t seed) {
  math::Random random(seed, "configuration of a process");
  RunResult result;
  result.measured = 0;
  for (int i = 0; i < kConfigurationErrors; ++i) refuse_one(random, result);
  return result;
}

}  // namespace

std::vector<Row> process_rows() {
  constexpr double kLater = 200;  // ms
  std::vector<Row> rows;
  for (const Row& row : faults::all_rows()) {
    if (row.number == "21") {
      rows.push_back(
          {row.number, std::to_string(kConfigurationErrors) + " errors in the configuration",
           "exit code 78 with file, line and key", "unnamed", 0, false, refuse_configurations});
    }
    if (!row.scenario) continue;
    Row process{row.number,
                row.fault,
                "taken as in virtual time, told 200 ms later at most",
                "ms later",
                kLater,
                false,
                [make = row.scenario](const Bench& bench, std::uint64_t seed) {
                  return play_to_process(bench, make(bench, seed));
                }};
    rows.push_back(process);
    if (row.number == "19") rows.push_back(killed_simulator_row());
  }
  return rows;
}

std::vector<Row> choose_process_rows(const std::vector<std::string>& numbers) {
  return faults::choose_rows(process_rows(), numbers);
}

}  // namespace palpate::faults
