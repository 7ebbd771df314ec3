#pragma once

#include <vector>

#include "tools/lab/faults/rows.hpp"

namespace palpate::faults {

/// Reason of failure of a run that could not be played in time in five attempts.
inline constexpr const char* kNotPlayed = "could not be played as it is: the machine is too busy";

/// The rows of virtual time that can be applied to a process from outside: `run` starts palpated
/// with its own ports and plays the same scenario in real time; in addition, the simulator is
/// killed and restarted. Passes if the process reacts as in virtual time and reports the fault at
/// most 200 ms later: 100 ms plus the period of HEALTH.
std::vector<faults::Row> process_rows();

/// Those whose numbers are in `numbers`; all if it is empty. Throws std::invalid_argument for an
/// unknown number.
std::vector<faults::Row> choose_process_rows(const std::vector<std::string>& numbers);

}  // namespace palpate::faults
