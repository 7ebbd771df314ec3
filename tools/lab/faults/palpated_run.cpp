#include "tools/lab/faults/palpated_run.hpp"

#include <csignal>
#include <fstream>
#include <stdexcept>

#include "tools/common/interruption.hpp"
#include "tools/lab/faults/fault_wire.hpp"

namespace palpate::faults {

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text << '\n';
  if (!out) throw std::runtime_error("cannot write " + file.string());
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
  write_text(file, configuration.dump());
  return {"palpated",
          {(common::program_folder() / "palpated").string(), "--config", file.string(), "--set",
           "bus.control=" + urls.control, "--set", "bus.housekeeping=" + urls.housekeeping},
          folder / "palpated.txt"};
}

PalpatedRun run_palpated(const Bench& bench, const Scenario& scenario) {
  constexpr double kRunPatience = 20;  // s, until it publishes its first message
  const common::TemporaryFolder folder("palpate-faults");
  const runs::Urls urls = runs::private_urls();
  const std::vector<std::string> overrides =
      scenario.held.length > 0 ? scenario.overrides : patient(scenario.overrides);
  const config::Node root = configuration(overrides);
  FaultWire wire(urls);
  common::Process daemon = start_palpated(root, urls, folder.path());
  for (double waited = 0; !wire.heard() && daemon.running() && waited < kRunPatience;
       waited += 0.01)
    common::sleep_for(0.01);

  wire.play(bench.recording, scenario, [&](int tick) {
    if (scenario.held.length == 0) return;
    if (tick == scenario.held.tick) kill(daemon.pid(), SIGSTOP);
    if (tick == scenario.held.tick + scenario.held.length) kill(daemon.pid(), SIGCONT);
  });
  PalpatedRun run;
  run.alive = daemon.running();
  run.trace = wire.trace(scenario.ticks, registry::read_gate_limits(root), kTick);
  run.exit_code = daemon.stop();
  run.words = common::tail(daemon.output(), 1);
  run.last_gap = wire.last_gap();
  run.latest = wire.latest();
  return run;
}

}  // namespace palpate::faults
