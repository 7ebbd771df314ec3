#pragma once

#include <semaphore.h>

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "rt/bus/message_bus.hpp"
#include "rt/loop/handover_ring.hpp"

namespace palpate::bus {

/// Publishes messages of the loop from a thread of its own: sending to a multicast group executes
/// the receiving side of the network stack in the sender's time, ten times that of the encoding,
/// which the loop does here. If the queue is full, the oldest message is dropped. Lost messages are
/// counted; the loop never waits.
class TelemetryPublisher final : public Outlet {
 public:
  /// As MessageBus::publish(); called by the publisher's thread.
  using Send = std::function<bool(const char* channel, const void* data, int size)>;

  /// Queue of `depth` messages of at most `largest` encoded bytes; allocates (depth + 2) * largest
  /// bytes. Throws std::invalid_argument unless both are positive.
  TelemetryPublisher(Send send, int depth, int largest);
  /// Publishes the queued messages, then ends.
  ~TelemetryPublisher();
  TelemetryPublisher(const TelemetryPublisher&) = delete;
  TelemetryPublisher& operator=(const TelemetryPublisher&) = delete;

  std::uint8_t* buffer(int size) noexcept override;
  bool commit(const char* channel, int size) noexcept override;

  /// Number of messages that were not sent: queue full, too large, or rejected by the bus.
  std::int64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  struct Record {
    char channel[kLongestChannel + 1];  // zero-terminated
    int size;                           // bytes of the message
    std::vector<std::uint8_t> data;     // capacity of the largest one
  };
  static Record empty_record(int largest);
  void lose_one() noexcept { lost_.fetch_add(1, std::memory_order_relaxed); }
  void wake() noexcept;
  void work() noexcept;
  bool publish_queued() noexcept;  // false if the queue was empty

  Send send_;
  int largest_;
  loop::HandoverRing<Record> queue_;
  std::atomic<std::int64_t> lost_{0};
  std::atomic<bool> stop_{false};
  std::atomic<bool> asleep_{false};
  sem_t wake_;
  std::thread thread_;
};

}  // namespace palpate::bus
