#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/lab/faults/judge.hpp"
#include "tools/lab/faults/transforms.hpp"

namespace palpate::faults {

/// A fault as seen from outside of a daemon: the messages that arrive, and the actions of its user.
/// Plays in virtual time as well as to a process.
struct Scenario {
  Stream stream;
  Window window;        // of the fault
  std::string channel;  // the fault concerns, if it is a single one
  int ticks = 0;        // ms until the end, including time to recover
  bool must_show = true;
  std::vector<std::string> overrides;  // of the daemon's configuration

  /// User actions in addition to the start and the target of every run.
  struct Act {
    int tick;
    std::function<void(client::Client&)> act;
  };
  std::vector<Act> acts;

  /// The daemon's process is stopped from `tick` for this many ms; 0: never.
  struct Held {
    int tick = 0;
    int length = 0;
  };
  Held held;

  /// In virtual time only: offset, in us, of the daemon's wall clock.
  std::function<std::int64_t(std::int64_t)> clock_offset;
};

/// In virtual time.
Trace play(const Bench& bench, const Scenario& scenario);

/// `row` with the scenario that `make` returns for a seed, played in virtual time and judged by
/// `judge`.
Row scenario_row(Row row, std::function<Scenario(const Bench&, std::uint64_t seed)> make,
                 std::function<RunResult(const Bench&, const Scenario&)> judge);

/// The window from where the scenario's stream first differs from the fault-free one.
Window from_first(const Stream& faulted, const Bench& bench, const Window& window);

}  // namespace palpate::faults
