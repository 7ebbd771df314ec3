#include "sim/scenes/pacing.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <palpate/channels.hpp>

#include "rt/loop/fixed_rate_loop.hpp"

namespace palpate::scenes {
namespace {

constexpr std::int64_t kMostMadeUpFor = 20'000'000;  // ns
constexpr std::int64_t kSecond = 1'000'000'000;

}  // namespace

constexpr std::chrono::milliseconds kRepeat{5};

LockStep::LockStep(bus::MessageBus& control, std::int64_t session, double patience)
    : control_(control),
      ticks_(control, channel::kSimTick, session),
      done_(control, channel::kTickDone, 64),
      patience_(
          std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(patience))) {}

void LockStep::send(std::int64_t tick, std::int64_t period_us, std::int64_t utime) {
  tick_.tick = tick;
  tick_.period_us = period_us;
  tick_.utime = utime;
  publish();
}

void LockStep::publish() {
  ticks_.publish(tick_, tick_.utime);
  sent_ = Clock::now();
}

bool LockStep::answered() {
  tick_done_t message{};
  std::int64_t arrival_ns = 0;
  while (done_.take(message, arrival_ns))
    if (message.tick == tick_.tick) return true;
  return false;
}

LockStep::Answer LockStep::wait(const std::atomic<bool>& stop) {
  const auto give_up = Clock::now() + patience_;
  control_.receive(0);
  while (!answered()) {
    if (stop) return Answer::kStopped;
    const auto now = Clock::now();
    if (now >= give_up) return Answer::kNone;
    if (now >= sent_ + kRepeat) {
      publish();
      ++repeats_;
    }
    const std::chrono::nanoseconds pause = std::min(sent_ + kRepeat, give_up) - now;
    control_.receive(std::max<std::int64_t>(0, pause.count()));
  }
  return Answer::kDone;
}

RealTimePacer::RealTimePacer(std::int64_t period_ns) : period_ns_(period_ns) {}

void RealTimePacer::wait() {
  if (next_ns_ == 0) next_ns_ = loop::monotonic_ns();
  const timespec due{next_ns_ / kSecond, next_ns_ % kSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
  }
  const std::int64_t late = loop::monotonic_ns() - next_ns_;
  worst_ns_ = std::max(worst_ns_, late);
  if (late >= period_ns_) ++overruns_;
  if (late > kMostMadeUpFor) {
    lost_ns_ += late;
    next_ns_ += late;
  }
  next_ns_ += period_ns_;
}

}  // namespace palpate::scenes
