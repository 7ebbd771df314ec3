#pragma once

#include <semaphore.h>

#include <atomic>
#include <thread>

#include "rt/bus/message_bus.hpp"
#include "rt/loop/telemetry_queue.hpp"

namespace palpate::bus {

/// Publishes messages of the loop from a thread of its own: sending to a multicast group executes
/// the receiving side of the network stack in the sender's time, ten times that of the copy which
/// the loop makes here. Lost messages are counted; the loop never waits.
class TelemetryPublisher {
 public:
  /// Queue of `depth` messages of at most `largest` encoded bytes. From now on the publisher's
  /// thread is the one that publishes on `bus`, which must outlive this object.
  TelemetryPublisher(MessageBus& bus, int depth, int largest);
  /// Publishes the queued messages, then ends.
  ~TelemetryPublisher();
  TelemetryPublisher(const TelemetryPublisher&) = delete;
  TelemetryPublisher& operator=(const TelemetryPublisher&) = delete;

  /// Called by the loop's thread with an encoded message. False if it is larger than `largest` or
  /// the channel name is too long.
  bool publish(const char* channel, const void* data, int size) noexcept;

  /// Number of messages that were not sent: queue full, too large, or rejected by the bus.
  std::int64_t lost() const noexcept {
    return queue_.dropped() + queue_.rejected() + failed_.load(std::memory_order_relaxed);
  }

 private:
  void wake() noexcept;
  void work() noexcept;
  bool publish_queued() noexcept;  // false if the queue was empty

  MessageBus& bus_;
  loop::TelemetryQueue queue_;
  std::atomic<std::int64_t> failed_{0};
  std::atomic<bool> stop_{false};
  std::atomic<bool> asleep_{false};
  sem_t wake_;
  std::thread thread_;
};

}  // namespace palpate::bus
