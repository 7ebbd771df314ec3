#pragma once

#include "tools/lab/endurance/soak.hpp"

namespace palpate::endurance {

/// Hours of closed loop in virtual time with a random mix of faults (faults::LongRun). Prints
/// faults, recoveries, memory and the error at rest of the first and of the last tenth. Exit code 1
/// if a check failed, or memory grows by more than 1 MB per hour after warm-up.
int run_virtual_soak(const SoakOptions& options);

}  // namespace palpate::endurance
