#pragma once

#include <string>
#include <vector>

#include "tools/lab/faults/scenario.hpp"
#include "tools/lab/unruly/settings.hpp"

namespace palpate::faults {

/// Components of plug-ins that violate the rules of their interface, in a random slot.
/// In virtual time: errors in the loop.
std::vector<Row> plugin_rows();
/// Of palpated: those, hangs in the loop, and failures at set-up.
std::vector<Row> plugin_process_rows();

/// The fault-free stream for a configuration with an unruly component that does this from a random
/// cycle on. `fallback`: whether it has one.
Scenario plugin_scenario(const Bench& bench, const unruly::Slot& slot, const std::string& does,
                         bool fallback, math::Random& random);

/// Its fallback commands by the end, or the command comes to zero and stays there; either is
/// reported. `measured`: ms until then.
RunResult judge_plugin_error(const Trace& trace, bool fallback);

}  // namespace palpate::faults
