#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace palpate::loop {

/// One cycle of a fixed-rate loop.
struct Tick {
  std::int64_t now_ns;       // CLOCK_MONOTONIC at wake-up
  std::int64_t lateness_ns;  // delay after the grid point
  std::int64_t missed;       // grid points skipped before this one
};

/// Absolute time grid of a fixed-rate loop, as pure arithmetic on clock readings. A cycle that ends
/// after the next grid point, or a wake-up late by a period or more, is one overrun; the grid
/// points that it covers are skipped, so that missed cycles are not repeated and the grid never
/// drifts.
class TimeGrid {
 public:
  /// Throws std::invalid_argument unless period_ns > 0.
  explicit TimeGrid(std::int64_t period_ns);

  /// Resets the grid; the next begin_wait() starts a new one.
  void restart() noexcept { started_ = false; }

  /// Ends the cycle at `now_ns`; returns the next wake-up time.
  std::int64_t begin_wait(std::int64_t now_ns) noexcept;

  /// Wake-up at `now_ns`, not before the time returned by begin_wait().
  Tick end_wait(std::int64_t now_ns) noexcept;

  std::int64_t overruns() const noexcept { return overruns_; }
  /// Total lateness of all overruns.
  std::int64_t overrun_ns() const noexcept { return overrun_ns_; }

 private:
  std::int64_t period_ns_;
  bool started_ = false;
  std::int64_t next_ns_ = 0;
  std::int64_t missed_ = 0;
  std::int64_t overruns_ = 0;
  std::int64_t overrun_ns_ = 0;
};

struct LoopOptions {
  double period = 1e-3;    // s
  int fifo_priority = 50;  // 0: SCHED_OTHER
  int cpu = -1;            // -1: any
  bool lock_memory = true;
};

/// Calls `tick(now_ns)` on an absolute CLOCK_MONOTONIC grid in the calling thread until `stop` is
/// set. After an overrun the grid is aligned to the next point in the future; missed cycles are not
/// repeated. `tick` must behave as noexcept: it neither allocates, locks, logs nor throws. It
/// receives the lateness of this wake-up, so that the caller can apply its own overrun policy.
class FixedRateLoop {
 public:
  explicit FixedRateLoop(const LoopOptions& options);

  /// Locks and prefaults memory, sets FIFO priority and affinity for the calling thread, as far as
  /// the system grants it. Returns the rejected settings with reason and remedy, one line each;
  /// empty if all were granted.
  std::string acquire_real_time();

  using Tick = loop::Tick;
  template <class F>
  void run(const std::atomic<bool>& stop, F&& tick);

  const TimeGrid& grid() const noexcept { return grid_; }

 private:
  Tick wait() noexcept;
  LoopOptions options_;
  TimeGrid grid_;
};

template <class F>
void FixedRateLoop::run(const std::atomic<bool>& stop, F&& tick) {
  grid_.restart();
  while (!stop.load(std::memory_order_relaxed)) tick(wait());
}

/// CLOCK_MONOTONIC in ns.
std::int64_t monotonic_ns() noexcept;

}  // namespace palpate::loop
