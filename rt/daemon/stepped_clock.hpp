#pragma once

#include <atomic>
#include <palpate/channels.hpp>
#include <palpate/sim_tick_t.hpp>
#include <palpate/tick_done_t.hpp>

#include "rt/daemon/daemon.hpp"

namespace palpate::daemon {

/// Lock-step with a simulator: one cycle per SIM_TICK, acknowledged by TICK_DONE. A repeated tick
/// is acknowledged again but not executed again, so that either message may be lost. Create before
/// the bus starts.
class SteppedClock {
 public:
  SteppedClock(bus::MessageBus& control, std::int64_t session)
      : ticks_(control, channel::kSimTick, 8), done_(control, channel::kTickDone, session) {}

  /// Executes received ticks; false if there were none.
  bool run_pending(Daemon& daemon) noexcept {
    std::int64_t arrival_ns = 0;
    bool any = false;
    while (ticks_.take(tick_, arrival_ns)) {
      any = true;
      if (tick_.session != sim_session_) {
        sim_session_ = tick_.session;
        last_tick_ = tick_.tick - 1;
      }
      if (tick_.tick > last_tick_) {
        last_tick_ = tick_.tick;
        // Ages are in simulated time, which is accumulated here and therefore continues when a
        // simulator restarts.
        now_ns_ += 1000 * tick_.period_us;
        Now now;
        now.monotonic_ns = now_ns_;
        now.utime = tick_.utime;
        now.stepped = true;
        daemon.tick(now);
      }
      answer_.tick = tick_.tick;
      done_.publish(answer_, tick_.utime);
    }
    return any;
  }

 private:
  bus::TypedSubscription<sim_tick_t> ticks_;
  bus::StampedPublisher<tick_done_t> done_;
  sim_tick_t tick_{};
  tick_done_t answer_{};
  std::int64_t sim_session_ = 0;
  std::int64_t last_tick_ = -1;
  std::int64_t now_ns_ = 0;
};

}  // namespace palpate::daemon
