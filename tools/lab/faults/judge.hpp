#pragma once

#include "tools/lab/faults/replay.hpp"
#include "tools/lab/faults/result.hpp"

namespace palpate::faults {

/// Fault-free stream and the daemon's response to it, with which every run is compared.
struct Bench {
  Recording recording;
  Trace reference;
};
/// Records and replays. Throws config::Error, and std::runtime_error if the fault-free run is not
/// sound or does not move.
Bench make_bench();

inline constexpr double kTick = 1e-3;  // s
inline constexpr double kVisibleWithin =
    0.1;  // s, every fault must be reported in HEALTH or an event
inline constexpr double kNextMessage = 0.01;  // s, by which a loss must be detected
inline constexpr double kZeroWithin = 0.1;    // s, age of a command that must no longer be followed

/// s from `from` until HEALTH or an event reports something that differs from the fault-free run;
/// -1: never.
double visible_after(const Trace& trace, const Trace& reference, double from);
/// s from `from` until the first state other than active before `until`; -1: never.
double inactive_after(const Trace& trace, double from, double until);
/// s from `from` until it is active and stays so to the end; -1: never.
double active_again_after(const Trace& trace, double from);
/// s from `from` until the command is zero, and stays so until `until`; -1: never.
double zero_after(const Trace& trace, double from, double until);
/// Cycles with different output; with or without contacts.
int different_cycles(const Trace& trace, const Trace& reference, bool contacts);
/// RMS of the shape error within the window, m.
double shape_rmse(const Trace& trace, const Window& window);

/// Time at which the faulted stream first differs from the fault-free one, s.
double first_difference(const Stream& faulted, const Stream& good);

/// Outcome and times of a fault that lasts for `window`; a failure if a number is not finite or a
/// command exceeds the limits.
RunResult outcome_of(const Trace& trace, const Window& window);

/// Applies the checks of the whole table: outcome and times of a fault that lasts for `window`;
/// every number finite, every command within the limits, no fault unreported. `must_show`: the
/// fault must be reported even if it does no harm.
RunResult judge(const Trace& trace, const Trace& reference, const Window& window, bool must_show);

}  // namespace palpate::faults
