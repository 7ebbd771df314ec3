#pragma once

#include <cstdint>

namespace palpate::scenes {

/// Paces a simulation to the real clock: tick n begins at start + n periods of CLOCK_MONOTONIC.
/// After a short delay the simulation catches up, so that simulated time stays real time; after a
/// long one the time grid is shifted, and simulated time lags by that amount.
class RealTimePacer {
 public:
  explicit RealTimePacer(std::int64_t period_ns);

  /// Sleeps until the next tick is due.
  void wait();

  std::int64_t overruns() const { return overruns_; }  // ticks that began at least one period late
  std::int64_t worst_lateness_ns() const { return worst_ns_; }
  std::int64_t lost_ns() const { return lost_ns_; }  // total shift of the grid

 private:
  std::int64_t period_ns_;
  std::int64_t next_ns_ = 0;  // 0: not started
  std::int64_t overruns_ = 0;
  std::int64_t worst_ns_ = 0;
  std::int64_t lost_ns_ = 0;
};

}  // namespace palpate::scenes
