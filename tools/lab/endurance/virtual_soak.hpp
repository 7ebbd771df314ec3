#pragma once

#include "tools/lab/endurance/soak.hpp"

namespace palpate::endurance {

/// Hours of closed loop in virtual time under a random mix of faults (faults::LongRun). Prints
/// faults, recoveries, memory and the error at rest of the first and of the last tenth. Exit code 1
/// where something failed, or memory grows by more than 1 MB an hour after warm-up.
int run_virtual_soak(const SoakOptions& options);

}  // namespace palpate::endurance
