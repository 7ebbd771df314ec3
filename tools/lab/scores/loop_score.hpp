#pragma once

#include "core/control/safety_gate.hpp"
#include "tools/log/log_reader.hpp"

namespace palpate::scores {

/// The daemon's loop statistics in its last HEALTH.
struct LoopScore {
  std::int64_t cycles = 0;
  std::int64_t overruns = 0;
  double overrun_ms = 0;                                   // total wake-up latency
  double p50_us = 0, p99_us = 0, p999_us = 0, max_us = 0;  // of a whole cycle
  double wake_up_max_us = 0;
  std::int64_t shapes_not_converged = 0;
  std::int64_t allocations = 0;  // of the loop's thread since activation; -1: not counted
  std::int64_t page_faults = 0;  // likewise
  std::int64_t gate_limited = 0;
  std::int64_t gate_rejected = 0;
  int state = 0;         // health_t.state
  bool faulted = false;  // at any time of the run
  std::string reason;    // of the last state that was not active
};

/// Throws std::runtime_error if the log holds no HEALTH.
LoopScore score_loop(const log::RunLog& run);

/// The largest commands of a run and the number of limit violations.
struct CommandScore {
  long commands = 0;
  double linear_speed = 0;          // m/s
  double angular_speed = 0;         // rad/s
  double linear_acceleration = 0;   // m/s^2, while accelerating
  double angular_acceleration = 0;  // rad/s^2
  long violations = 0;  // commands beyond a limit, not finite, or accelerating while not valid
  long outside_workspace = 0;  // robot states with the flange outside the workspace
};

/// `period`: s between two commands of consecutive sequence numbers. Stopping at once is allowed.
CommandScore check_commands(const log::RunLog& run, const control::GateLimits& limits,
                            double period);

}  // namespace palpate::scores
