#include "sim/scenes/real_time_pacer.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace palpate::scenes {
namespace {

constexpr std::int64_t kMostMadeUpFor = 20'000'000;  // ns
constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecond + now.tv_nsec;
}

}  // namespace

RealTimePacer::RealTimePacer(std::int64_t period_ns) : period_ns_(period_ns) {}

void RealTimePacer::wait() {
  if (next_ns_ == 0) next_ns_ = now_ns();
  const timespec due{next_ns_ / kSecond, next_ns_ % kSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
  }
  const std::int64_t late = now_ns() - next_ns_;
  worst_ns_ = std::max(worst_ns_, late);
  if (late >= period_ns_) ++overruns_;
  if (late > kMostMadeUpFor) {
    lost_ns_ += late;
    next_ns_ += late;
  }
  next_ns_ += period_ns_;
}

}  // namespace palpate::scenes
