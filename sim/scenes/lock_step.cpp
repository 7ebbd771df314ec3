#include "sim/scenes/lock_step.hpp"

#include <chrono>
#include <thread>

namespace palpate::scenes {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;
using std::chrono::milliseconds;

LockStep::LockStep(bus::MessageBus& control, std::int64_t session, double patience)
    : ticks_(control, "SIM_TICK"),
      done_(control, "TICK_DONE", 64),
      stamp_(session),
      patience_(patience) {}

bool LockStep::answered(std::int64_t tick) {
  tick_done_t message{};
  std::int64_t arrival_ns = 0;
  while (done_.take(message, arrival_ns))
    if (message.tick == tick) return true;
  return false;
}

LockStep::Answer LockStep::exchange(std::int64_t tick, std::int64_t period_us, std::int64_t utime,
                                    const std::atomic<bool>& stop) {
  sim_tick_t message{};
  message.tick = tick;
  message.period_us = period_us;
  const auto give_up = Clock::now() + std::chrono::duration<double>(patience_);
  for (bool first = true; Clock::now() < give_up; first = false) {
    if (!first) ++repeats_;
    stamp_.put(message, utime);
    ticks_.publish(message);
    for (const auto repeat = Clock::now() + milliseconds(5); Clock::now() < repeat;) {
      if (answered(tick)) return Answer::kDone;
      if (stop) return Answer::kStopped;
      std::this_thread::sleep_for(microseconds(20));
    }
  }
  return Answer::kNone;
}

}  // namespace palpate::scenes
