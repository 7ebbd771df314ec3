#include "rt/loop/time_grid.hpp"

#include <stdexcept>
#include <string>

namespace palpate::loop {

TimeGrid::TimeGrid(std::int64_t period_ns) : period_ns_(period_ns) {
  if (period_ns <= 0)
    throw std::invalid_argument("period of the loop must be positive, not " +
                                std::to_string(period_ns) + " ns");
}

std::int64_t TimeGrid::begin_wait(std::int64_t now_ns) noexcept {
  missed_ = 0;
  if (!started_) {
    started_ = true;
    next_ns_ = now_ns + period_ns_;
    return next_ns_;
  }
  next_ns_ += period_ns_;
  const std::int64_t past_end = now_ns - next_ns_;
  if (past_end > 0) {
    ++overruns_;
    overrun_ns_ += past_end;
    missed_ = past_end / period_ns_ + 1;
    next_ns_ += missed_ * period_ns_;
  }
  return next_ns_;
}

Tick TimeGrid::end_wait(std::int64_t now_ns) noexcept {
  const Tick tick{now_ns, now_ns - next_ns_, missed_};
  if (tick.lateness_ns < period_ns_) return tick;
  // the cycle that starts now belongs to the last grid point that has passed
  ++overruns_;
  overrun_ns_ += tick.lateness_ns;
  const std::int64_t slept_through = tick.lateness_ns / period_ns_;
  next_ns_ += slept_through * period_ns_;
  return {tick.now_ns, tick.lateness_ns, tick.missed + slept_through};
}

}  // namespace palpate::loop
