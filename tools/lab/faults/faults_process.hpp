#pragma once

#include <vector>

#include "tools/lab/faults/rows.hpp"

namespace palpate::faults {

/// Why a run failed that five attempts could not play in time.
inline constexpr const char* kNotPlayed = "could not be played as it is: the machine is too busy";

/// The rows of virtual time that can be done to a process from outside, so done: `run` starts
/// palpated with ports of its own and plays it the same scenario in real time; to that comes the
/// simulator killed and started anew. What counts is that a process takes it as virtual time does,
/// and tells it at most 200 ms later: 100 ms and the period of HEALTH.
std::vector<faults::Row> process_rows();

/// Those whose numbers are in `numbers`; all where it is empty. Throws std::invalid_argument for a
/// number that no row has.
std::vector<faults::Row> choose_process_rows(const std::vector<std::string>& numbers);

}  // namespace palpate::faults
