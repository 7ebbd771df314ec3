#pragma once

#include <semaphore.h>

#include <atomic>
#include <thread>

#include "rt/bus/message_bus.hpp"
#include "rt/loop/telemetry_queue.hpp"

namespace palpate::bus {

/// Publishes from a thread of its own what the loop hands over, so that large messages cost the
/// loop no more than their encoding. What is lost is counted, never waited for.
class TelemetryPublisher {
 public:
  /// Room for `depth` messages of at most `largest` encoded bytes. From now on the publisher's
  /// thread is the one that publishes on `bus`, which must outlive it.
  TelemetryPublisher(MessageBus& bus, int depth, int largest);
  /// Publishes what is queued, then ends.
  ~TelemetryPublisher();
  TelemetryPublisher(const TelemetryPublisher&) = delete;
  TelemetryPublisher& operator=(const TelemetryPublisher&) = delete;

  /// From the loop's thread. False where the message is larger than `largest` or not encodable.
  template <class T>
  bool publish(const char* channel, const T& message) noexcept {
    int size = message.getEncodedSize();
    if (size <= queue_.largest()) size = message.encode(queue_.buffer(), 0, size);
    if (!queue_.commit(channel, size)) return false;
    sem_post(&wake_);
    return true;
  }

  /// Messages that did not reach the network: queue full, too large, or refused by the bus.
  std::int64_t lost() const noexcept {
    return queue_.dropped() + queue_.refused() + failed_.load(std::memory_order_relaxed);
  }

 private:
  void work() noexcept;

  MessageBus& bus_;
  loop::TelemetryQueue queue_;
  std::atomic<std::int64_t> failed_{0};
  std::atomic<bool> stop_{false};
  sem_t wake_;
  std::thread thread_;
};

}  // namespace palpate::bus
