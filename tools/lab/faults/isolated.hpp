#pragma once

#include <functional>
#include <vector>

#include "tools/lab/faults/result.hpp"

namespace palpate::faults {

/// Runs task(0) to task(count - 1) in `jobs` processes, so that a crash or a hang (a minute) of one
/// is an outcome like any other and the rest continues. `done` is called with the number of results
/// so far. Results are in order. For single-threaded programs. Throws std::runtime_error if no
/// process can be created.
std::vector<RunResult> run_isolated(int count, int jobs, const std::function<RunResult(int)>& task,
                                    const std::function<void(int)>& done = {});

}  // namespace palpate::faults
