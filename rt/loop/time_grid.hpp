#pragma once

#include <cstdint>

namespace palpate::loop {

/// One cycle of a fixed-rate loop.
struct Tick {
  std::int64_t now_ns;       // CLOCK_MONOTONIC at wake-up
  std::int64_t lateness_ns;  // after the grid point
  std::int64_t missed;       // grid points skipped before this one
};

/// The absolute time grid of a fixed-rate loop, as arithmetic on a clock that somebody else reads.
/// A cycle that ends after the next grid point, or a wake-up a period or more late, is one overrun;
/// the grid points it covers are skipped, so that nothing is caught up and the grid never drifts.
class TimeGrid {
 public:
  /// Throws std::invalid_argument unless period_ns > 0.
  explicit TimeGrid(std::int64_t period_ns);

  /// Forgets the grid; the next begin_wait() starts another one.
  void restart() noexcept { started_ = false; }

  /// The cycle is over at `now_ns`: returns when to wake up.
  std::int64_t begin_wait(std::int64_t now_ns) noexcept;

  /// Woken up at `now_ns`, not before what begin_wait() returned.
  Tick end_wait(std::int64_t now_ns) noexcept;

  std::int64_t overruns() const noexcept { return overruns_; }
  /// Lateness of all overruns together.
  std::int64_t overrun_ns() const noexcept { return overrun_ns_; }

 private:
  std::int64_t period_ns_;
  bool started_ = false;
  std::int64_t next_ns_ = 0;
  std::int64_t missed_ = 0;
  std::int64_t overruns_ = 0;
  std::int64_t overrun_ns_ = 0;
};

}  // namespace palpate::loop
