#pragma once

#include "tools/lab/faults/scenario.hpp"

namespace palpate::faults {

/// s from `from` until HEALTH or an event of a process reports something that it did not before;
/// -1: never. Unlike visible_after() it needs no second run, since runs of a process are not
/// repeatable.
double reported_after(const Trace& trace, double from);

/// Whether it was active at some time before `time`.
bool has_run(const Trace& trace, double time);

/// Checks that need no other run: outcome and times of a fault, sound output, no command while
/// inactive, fault reported.
RunResult judge_alone(const Trace& trace, const Window& window);

/// Compares a process in a scenario with the same in virtual time: equally sound, no command while
/// inactive, zero and recovered where virtual time is, and every fault reported. `measured`: ms by
/// which the process reports it later than virtual time does. Additional effects of a busy machine,
/// such as a late sensor, are not failures.
RunResult judge_process(const Trace& trace, const Trace& expected, const Bench& bench,
                        const Scenario& scenario);

}  // namespace palpate::faults
