#pragma once

#include <cstdint>

namespace palpate::scenes {

/// Holds a simulation to the real clock: tick n begins at start + n periods of CLOCK_MONOTONIC. A
/// short delay is made up for, so that simulated time stays real time; after a long one the grid
/// moves, and simulated time stays behind by as much.
class RealTimePacer {
 public:
  explicit RealTimePacer(std::int64_t period_ns);

  /// Sleeps until the next tick is due.
  void wait();

  std::int64_t overruns() const { return overruns_; }  // ticks that began a period late or more
  std::int64_t worst_lateness_ns() const { return worst_ns_; }
  std::int64_t lost_ns() const { return lost_ns_; }  // by which the grid moved

 private:
  std::int64_t period_ns_;
  std::int64_t next_ns_ = 0;  // 0: not begun
  std::int64_t overruns_ = 0;
  std::int64_t worst_ns_ = 0;
  std::int64_t lost_ns_ = 0;
};

}  // namespace palpate::scenes
