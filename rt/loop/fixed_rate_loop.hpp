#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "rt/loop/latency_histogram.hpp"
#include "rt/loop/time_grid.hpp"

namespace palpate::loop {

/// Real-time settings granted by the operating system, one line each for the log.
struct RealTimeGrant {
  bool memory_locked = false;
  bool fifo = false;
  bool affinity = false;
  std::string remarks;  // rejected settings with reason and remedy; empty if all were granted
};

struct LoopOptions {
  double period = 1e-3;    // s
  int fifo_priority = 50;  // 0: SCHED_OTHER
  int cpu = -1;            // -1: any
  bool lock_memory = true;
};

struct LoopStatistics {
  std::int64_t cycles = 0;
  /// Wake-ups late by a period or more, and cycles beyond their period; each counts once.
  std::int64_t overruns = 0;
  std::int64_t overrun_ns = 0;  // their total lateness
  LatencyHistogram wake_up;     // wake-up latency
};

/// Calls `tick(now_ns)` on an absolute CLOCK_MONOTONIC grid in the calling thread until `stop` is
/// set. After an overrun the grid is aligned to the next point in the future; missed cycles are not
/// repeated. `tick` must behave as noexcept: it neither allocates, locks, logs nor throws. It
/// receives the lateness of this wake-up, so that the caller can apply its own overrun policy.
class FixedRateLoop {
 public:
  explicit FixedRateLoop(const LoopOptions& options);

  /// Locks and prefaults memory, sets FIFO priority and affinity for the calling thread, as far as
  /// granted.
  RealTimeGrant acquire_real_time();

  using Tick = loop::Tick;
  template <class F>
  void run(const std::atomic<bool>& stop, F&& tick);

  const LoopStatistics& statistics() const noexcept { return statistics_; }

 private:
  Tick wait() noexcept;
  LoopOptions options_;
  LoopStatistics statistics_;
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
