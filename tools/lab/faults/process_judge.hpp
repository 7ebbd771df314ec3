#pragma once

#include "tools/lab/faults/scenario.hpp"

namespace palpate::faults {

/// s from `from` until HEALTH or an event of a process says something that it did not before; -1:
/// never. Unlike visible_after() it needs no second run, which no process repeats.
double told_after(const Trace& trace, double from);

/// Whether it ran at some time before `time`.
bool has_run(const Trace& trace, double time);

/// What needs no other run: outcome and times of a fault, sound, no command while it is inactive,
/// not silent.
RunResult judge_alone(const Trace& trace, const Window& window);

/// How a process took a scenario, beside the same in virtual time: as sound, no command while it is
/// inactive, zero and recovered where virtual time is, and never silent. `measured`: ms that the
/// process tells it later than virtual time does. Whatever a busy machine adds, such as a sensor
/// that is late for its own reasons, is no failure.
RunResult judge_process(const Trace& trace, const Trace& expected, const Bench& bench,
                        const Scenario& scenario);

}  // namespace palpate::faults
