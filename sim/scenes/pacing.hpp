#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <palpate/sim_tick_t.hpp>
#include <palpate/tick_done_t.hpp>

#include "rt/bus/stamped_publisher.hpp"

namespace palpate::scenes {

/// The simulator's side of the stepped clock: sends SIM_TICK after each tick, and again every 5 ms
/// until the daemon answers with TICK_DONE, since UDP may lose either. Other lost messages, of
/// sensors or commands, are not resent.
class LockStep {
 public:
  enum class Answer { kDone, kNone, kStopped };

  /// Construct before the bus starts; uses no thread. `patience`: s to wait for an answer, which
  /// may take long on a busy machine.
  LockStep(bus::MessageBus& control, std::int64_t session, double patience = kPatience);
  static constexpr int kPatience = 20;

  /// Announces that all messages of `tick` have been sent.
  void send(std::int64_t tick, std::int64_t period_us, std::int64_t utime);

  /// Waits for the answer to the last tick, or until `stop` is set. Everything that the daemon
  /// published before the answer has then been received, and it publishes nothing more before the
  /// next tick is sent.
  Answer wait(const std::atomic<bool>& stop);

  std::int64_t repeats() const { return repeats_; }

 private:
  using Clock = std::chrono::steady_clock;
  bool answered();
  void publish();

  bus::MessageBus& control_;
  bus::StampedPublisher<sim_tick_t> ticks_;
  bus::TypedSubscription<tick_done_t> done_;
  Clock::duration patience_;
  Clock::time_point sent_;
  sim_tick_t tick_{};
  std::int64_t repeats_ = 0;
};

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
