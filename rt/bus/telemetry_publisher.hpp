#pragma once

#include <semaphore.h>

#include <atomic>
#include <thread>

#include "rt/bus/message_bus.hpp"
#include "rt/loop/telemetry_queue.hpp"

namespace palpate::bus {

/// Publishes from a thread of its own what the loop hands over: sending to a multicast group runs
/// the receiving side of the network in the sender's time, ten times that of the copy that the loop
/// pays here. What is lost is counted, never waited for.
class TelemetryPublisher {
 public:
  /// Room for `depth` messages of at most `largest` encoded bytes. From now on the publisher's
  /// thread is the one that publishes on `bus`, which must outlive it.
  TelemetryPublisher(MessageBus& bus, int depth, int largest);
  /// Publishes what is queued, then ends.
  ~TelemetryPublisher();
  TelemetryPublisher(const TelemetryPublisher&) = delete;
  TelemetryPublisher& operator=(const TelemetryPublisher&) = delete;

  /// From the loop's thread: an encoded message. False where it is larger than `largest` or the
  /// channel's name too long.
  bool publish(const char* channel, const void* data, int size) noexcept;

  /// Messages that did not reach the network: queue full, too large, or refused by the bus.
  std::int64_t lost() const noexcept {
    return queue_.dropped() + queue_.refused() + failed_.load(std::memory_order_relaxed);
  }

 private:
  void wake() noexcept;
  void work() noexcept;
  bool publish_queued() noexcept;  // false where there was nothing

  MessageBus& bus_;
  loop::TelemetryQueue queue_;
  std::atomic<std::int64_t> failed_{0};
  std::atomic<bool> stop_{false};
  std::atomic<bool> asleep_{false};
  sem_t wake_;
  std::thread thread_;
};

}  // namespace palpate::bus
