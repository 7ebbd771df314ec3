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

std::int64_t monotonic_ns() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * kSecond + time.tv_nsec;
}

FixedRateLoop::FixedRateLoop(const LoopOptions& options)
    : options_(options), grid_(nanoseconds_of(options.period)) {}

RealTimeGrant FixedRateLoop::acquire_real_time() {
  RealTimeGrant grant;
  const auto granted = [&grant](const std::string& refusal) {
    if (!refusal.empty()) grant.remarks += (grant.remarks.empty() ? "" : "\n") + refusal;
    return refusal.empty();
  };
  // Affinity and priority come last, so that prefaulting does not delay other threads.
  if (options_.lock_memory) grant.memory_locked = granted(lock_and_prefault_memory());
  if (options_.cpu >= 0) grant.affinity = granted(take_cpu(options_.cpu));
  if (options_.fifo_priority > 0) grant.fifo = granted(take_fifo(options_.fifo_priority));
  return grant;
}

Tick FixedRateLoop::wait() noexcept {
  sleep_until(grid_.begin_wait(monotonic_ns()));
  const Tick tick = grid_.end_wait(monotonic_ns());
  ++statistics_.cycles;
  statistics_.overruns = grid_.overruns();
  statistics_.overrun_ns = grid_.overrun_ns();
  statistics_.wake_up.record(tick.lateness_ns);
  return tick;
}

}  // namespace palpate::loop
