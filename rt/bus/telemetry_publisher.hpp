#pragma once

#include <semaphore.h>

#include <atomic>
#include <functional>
#include <thread>

#include "rt/bus/message_bus.hpp"
#include "rt/loop/telemetry_queue.hpp"

namespace palpate::bus {

/// Publishes messages of the loop from a thread of its own: sending to a multicast group executes
/// the receiving side of the network stack in the sender's time, ten times that of the encoding,
/// which the loop does here. Lost messages are counted; the loop never waits.
class TelemetryPublisher final : public Outlet {
 public:
  /// As MessageBus::publish(); called by the publisher's thread.
  using Send = std::function<bool(const char* channel, const void* data, int size)>;

  /// Queue of `depth` messages of at most `largest` encoded bytes.
  TelemetryPublisher(Send send, int depth, int largest);
  /// Publishes the queued messages, then ends.
  ~TelemetryPublisher();
  TelemetryPublisher(const TelemetryPublisher&) = delete;
  TelemetryPublisher& operator=(const TelemetryPublisher&) = delete;

  std::uint8_t* buffer(int size) noexcept override;
  bool commit(const char* channel, int size) noexcept override;

  /// Number of messages that were not sent: queue full, too large, or rejected by the bus.
  std::int64_t lost() const noexcept {
    return queue_.dropped() + queue_.rejected() + too_large_.load(std::memory_order_relaxed) +
           failed_.load(std::memory_order_relaxed);
  }

 private:
  void wake() noexcept;
  void work() noexcept;
  bool publish_queued() noexcept;  // false if the queue was empty

  Send send_;
  loop::TelemetryQueue queue_;
  std::atomic<std::int64_t> too_large_{0};
  std::atomic<std::int64_t> failed_{0};
  std::atomic<bool> stop_{false};
  std::atomic<bool> asleep_{false};
  sem_t wake_;
  std::thread thread_;
};

}  // namespace palpate::bus
