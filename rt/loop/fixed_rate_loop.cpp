#include "rt/loop/fixed_rate_loop.hpp"

#include <cerrno>
#include <cmath>
#include <ctime>
#include <stdexcept>

#include "rt/loop/real_time.hpp"

namespace palpate::loop {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t nanoseconds_of(double seconds) {
  if (!(seconds >= 1e-5 && seconds <= 10))
    throw std::invalid_argument("period of the loop must be 1e-5 to 10 s, not " +
                                std::to_string(seconds));
  return std::llround(seconds * 1e9);
}

void sleep_until(std::int64_t time_ns) noexcept {
  timespec time{};
  time.tv_sec = time_ns / kSecond;
  time.tv_nsec = time_ns % kSecond;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) == EINTR) {
  }
}

}  // namespace

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

std::int64_t monotonic_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * kSecond + time.tv_nsec;
}

FixedRateLoop::FixedRateLoop(const LoopOptions& options)
    : options_(options), grid_(nanoseconds_of(options.period)) {}

std::string FixedRateLoop::acquire_real_time() {
  std::string refusals;
  const auto note = [&refusals](const std::string& refusal) {
    if (!refusal.empty()) refusals += (refusals.empty() ? "" : "\n") + refusal;
  };
  // Affinity and priority come last, so that prefaulting does not delay other threads.
  if (options_.lock_memory) note(lock_and_prefault_memory());
  if (options_.cpu >= 0) note(take_cpu(options_.cpu));
  if (options_.fifo_priority > 0) note(take_fifo(options_.fifo_priority));
  return refusals;
}

Tick FixedRateLoop::wait() noexcept {
  sleep_until(grid_.begin_wait(monotonic_ns()));
  return grid_.end_wait(monotonic_ns());
}

}  // namespace palpate::loop
