#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::bus {

/// The last messages that passed by, kept ready as the bytes of an LCM event log. One thread
/// writes; nothing allocates after construction. The limits are a span of time and the room.
class LogRing {
 public:
  /// `room`: bytes; `span`: s. Throws std::invalid_argument unless both are positive.
  LogRing(std::size_t room, double span);

  /// Appends an event at `time_us` of the log's clock, which should not go back, and forgets what
  /// is older than the span or in the way. An event larger than the room is left out.
  void add(std::int64_t time_us, const std::string& channel, const void* data, int size) noexcept;

  void clear() noexcept;

  /// The log: two pieces, either of which may be empty. Of a ring that is written meanwhile (by a
  /// thread that crashes beside it) the oldest event may be broken, which readers of logs skip.
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
  // Of the stream of all bytes ever written: where the oldest event begins, where the next one
  // will.
  std::atomic<std::uint64_t> tail_{0}, head_{0};
};

}  // namespace palpate::bus
