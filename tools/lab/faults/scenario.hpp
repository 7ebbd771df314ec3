#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/lab/faults/judge.hpp"
#include "tools/lab/faults/transforms.hpp"

namespace palpate::faults {

/// A fault as it looks from outside of a daemon: what arrives, and what its user does. Plays in
/// virtual time as well as to a process.
struct Scenario {
  Stream stream;
  Window window;        // of the fault
  std::string channel;  // that it is of, where it is of one
  int ticks = 0;        // ms until the end, with time to recover
  bool must_show = true;
  std::vector<std::string> overrides;  // of the daemon's configuration

  /// Of the user, beside the start and the target that every run has.
  struct Act {
    int tick;
    std::function<void(User&)> act;
  };
  std::vector<Act> acts;

  /// The daemon's process is held still from `tick` for so many ms; 0: it is not.
  struct Held {
    int tick = 0;
    int length = 0;
  };
  Held held;

  /// Of virtual time alone: by how much, in us, the daemon's wall clock is off.
  std::function<std::int64_t(std::int64_t)> clock_offset;
};

/// In virtual time.
Trace play(const Bench& bench, const Scenario& scenario);

/// `row` with what `make` gives for a seed, played and judged by `judge` in virtual time.
Row scenario_row(Row row, std::function<Scenario(const Bench&, std::uint64_t seed)> make,
                 std::function<RunResult(const Bench&, const Scenario&)> judge);

/// The window from where the scenario's stream first differs from the good one.
Window from_first(const Stream& faulted, const Bench& bench, const Window& window);

}  // namespace palpate::faults
