#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::bus {

/// Ring buffer of the most recent messages, stored as the bytes of an LCM event log. One writing
/// thread; nothing allocates after construction. Limited by a time span and by its capacity.
class LogRing {
 public:
  /// `room`: capacity, bytes; `span`: s. Throws std::invalid_argument unless both are positive.
  LogRing(std::size_t room, double span);

  /// Appends an event at `time_us` of the log's clock, which should be monotonic, and removes
  /// events older than the span or in the way. An event larger than the capacity is omitted.
  void add(std::int64_t time_us, const std::string& channel, const void* data, int size) noexcept;

  void clear() noexcept;

  /// Log content in two pieces, either of which may be empty. If another thread writes concurrently
  /// (the reader being a crash handler), the oldest event may be corrupt; readers of logs skip it.
  struct Piece {
    const std::uint8_t* data;
    std::size_t size;
  };
  std::array<Piece, 2> pieces() const noexcept;

 private:
  std::uint64_t head() const noexcept { return head_.load(std::memory_order_relaxed); }
  std::uint64_t tail() const noexcept { return tail_.load(std::memory_order_relaxed); }
  void put(std::uint64_t at, const void* data, std::size_t size) noexcept;
  std::uint64_t get(std::uint64_t at, int bytes) const noexcept;
  void forget_oldest() noexcept;

  std::vector<std::uint8_t> bytes_;
  std::int64_t span_us_;
  std::int64_t events_ = 0;
  // positions in the stream of all bytes ever written: start of the oldest event, start of the next
  // one
  std::atomic<std::uint64_t> tail_{0}, head_{0};
};

}  // namespace palpate::bus
