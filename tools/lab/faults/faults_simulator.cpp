#include "tools/lab/faults/faults_simulator.hpp"

#include <unistd.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "rt/config/installation.hpp"
#include "tools/lab/faults/fault_wire.hpp"
#include "tools/lab/faults/judge.hpp"
#include "tools/lab/faults/process_judge.hpp"

namespace palpate::faults {
namespace {

using faults::Bench;
using faults::RunResult;

constexpr double kFaultsSimulatorPatience = 40;  // s; the plant settles first
constexpr double kBraked = 0.5;                  // s after which all motion must have ended

std::string source(const char* path) { return (config::data_folder() / path).string(); }

common::Process start_simulator(const runs::Urls& urls, const std::filesystem::path& folder,
                                const char* words) {
  return {"palpate-sim",
          {(common::program_folder() / "palpate-sim").string(),
           source("sim/scenes/bar_long_soft_control.yaml"), "--set", "object.elements=[8, 1, 1]",
           "--set", "bus.control=" + urls.control, "--set", "bus.housekeeping=" + urls.housekeeping,
           "--set", "bus.pictures=" + urls.pictures},
          folder / words};
}

/// False if the condition is not met in time.
bool wait_until(runs::Operator& user, const std::function<bool()>& condition) {
  for (double waited = 0; waited < kFaultsSimulatorPatience; waited += 0.02) {
    if (condition()) return true;
    user.spin(0.02);
  }
  return condition();
}

bool starts(runs::Operator& user) {
  return wait_until(user, [&, next = 0]() mutable {
    if (next++ % 25 == 0) user.send_event("start");
    return user.is_active();
  });
}

RunResult kill_simulator(const Bench& bench, std::uint64_t seed) {
  math::Random random(seed, "simulator killed");
  const FaultFolder folder;
  const runs::Urls urls = runs::private_urls();
  const config::Node root = faults::configuration(patient({}));
  FaultWire wire(urls);
  common::Process daemon = start_palpated(root, urls, folder.path());
  RunResult result;
  runs::Operator user(urls);
  double killed = 0, again = 0;
  {
    const common::Process simulator = start_simulator(urls, folder.path(), "simulator.txt");
    if (!wait_until(user, [&] { return user.heard() && user.has_robot_state(); })) {
      result.fail("no simulator: " + common::tail(folder.path() / "simulator.txt", 1));
      return result;
    }
    wire.begin();
    if (!starts(user)) result.fail("does not become active");
    runs::ControlTarget target;
    target.kind = "point";
    target.values = bench.recording.target;
    user.set_target(target);
    user.spin(0.3 + random.uniform(0, 0.5));
    killed = wire.now();
    kill(simulator.pid(), SIGKILL);
    user.spin(random.uniform(0, 0.5));
  }
  const common::Process simulator = start_simulator(urls, folder.path(), "simulator_again.txt");
  constexpr int kInactive = 1;
  if (!wait_until(user, [&] { return user.health() && user.health()->state == kInactive; }))
    result.fail("is not inactive beside a new simulator");
  user.spin(0.5);
  again = wire.now();
  if (!starts(user)) result.fail("does not become active again");

  const int ticks = static_cast<int>(wire.now() * 1e3);
  const faults::Trace trace = wire.trace(ticks, registry::read_gate_limits(root), faults::kTick);
  if (const int code = daemon.stop(); code != 0) {
    result.crashed = true;
    result.fail("palpated ended with exit code " + std::to_string(code));
  }
  const RunResult whole = faults::judge_alone(trace, {killed, again});
  if (!result.has_miss()) result = whole;
  const double zero = faults::zero_after(trace, killed, again);
  if (zero < 0 || zero > kBraked) result.fail("moves without a simulator, or before start");
  result.measured = 1e3 * zero;
  return result;
}

}  // namespace

FaultFolder::FaultFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "palpate_faults_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make the folder " + name);
  path_ = name;
}

FaultFolder::~FaultFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> patient(std::vector<std::string> overrides) {
  for (const char* key : {"loop.degraded_after_ms=5000", "loop.overrun_window_ms=5000",
                          "loop.safe_stop_after_ms=5000"})
    overrides.emplace_back(key);
  return overrides;
}

common::Process start_palpated(const config::Node& configuration, const runs::Urls& urls,
                               const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "palpated.yaml";
  std::ofstream out(file);
  out << configuration.dump() << '\n';
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
  return {"palpated",
          {(common::program_folder() / "palpated").string(), "--config", file.string(), "--set",
           "bus.control=" + urls.control, "--set", "bus.housekeeping=" + urls.housekeeping},
          folder / "palpated.txt"};
}

faults::Row killed_simulator_row() {
  return {"19",
          "simulator killed, started anew",
          "zero command in 100 ms, inactive until start",
          "ms",
          100,
          false,
          kill_simulator};
}

}  // namespace palpate::faults
