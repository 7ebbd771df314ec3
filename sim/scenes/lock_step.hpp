#pragma once

#include <atomic>
#include <cstdint>
#include <palpate/sim_tick_t.hpp>
#include <palpate/tick_done_t.hpp>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace palpate::scenes {

/// The simulator's side of the stepped clock: SIM_TICK after each tick, sent again every 5 ms until
/// the daemon answers TICK_DONE, since UDP may lose either.
class LockStep {
 public:
  enum class Answer { kDone, kNone, kStopped };

  /// Before the bus starts. `patience`: s to wait for an answer.
  LockStep(bus::MessageBus& control, std::int64_t session, double patience = 5);

  /// Waits for the answer to `tick`, or until `stop` is set.
  Answer exchange(std::int64_t tick, std::int64_t period_us, std::int64_t utime,
                  const std::atomic<bool>& stop);

  std::int64_t repeats() const { return repeats_; }

 private:
  bool answered(std::int64_t tick);

  bus::TypedPublisher<sim_tick_t> ticks_;
  bus::TypedSubscription<tick_done_t> done_;
  bus::Stamp stamp_;
  double patience_;
  std::int64_t repeats_ = 0;
};

}  // namespace palpate::scenes
