#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"
#include "tools/lab/faults/judge.hpp"
#include "tools/lab/faults/scenario.hpp"
#include "tools/lab/runs/live_run.hpp"

namespace palpate::faults {

void write_text(const std::filesystem::path& file, const std::string& text);

/// `overrides` plus settings that separate a busy machine's delays from the fault.
std::vector<std::string> patient(std::vector<std::string> overrides);

/// Starts palpated with that configuration and these ports; its output goes to palpated.txt in
/// `folder`.
common::Process start_palpated(const config::Node& configuration, const runs::Urls& urls,
                               const std::filesystem::path& folder);

/// A scenario as palpated met it, in real time over LCM.
struct PalpatedRun {
  Trace trace;
  bool alive = false;   // at the end of the scenario
  int exit_code = 0;    // after SIGTERM, or of its own
  std::string words;    // the last line of its output
  double last_gap = 0;  // s between its last two commands
  double latest = 0;    // s, largest delay of a sent message that this machine caused
};
PalpatedRun run_palpated(const Bench& bench, const Scenario& scenario);

}  // namespace palpate::faults
