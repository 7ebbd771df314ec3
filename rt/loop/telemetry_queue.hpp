#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>
#include <vector>

#include "rt/loop/handover_ring.hpp"

namespace palpate::loop {

/// Records of varying size from the loop to one publishing thread, without lock or allocation on
/// either side. If the queue is full, the oldest record is dropped and counted; that is never a
/// fault.
class TelemetryQueue {
 public:
  static constexpr int kLongestChannel = 63;
  struct Record {
    char channel[kLongestChannel + 1];  // zero-terminated
    int size;                           // valid bytes of data
    std::vector<std::uint8_t> data;     // capacity of the largest record
  };

  /// Throws std::invalid_argument unless depth and largest are positive. Allocates (depth + 2) *
  /// largest bytes.
  TelemetryQueue(int depth, int largest);

  /// Loop: buffer for encoding the next record, at most largest() bytes; then call commit().
  std::uint8_t* buffer() noexcept { return ring_.back().data.data(); }
  int largest() const noexcept { return largest_; }

  /// Loop: publishes the first `size` bytes of buffer(). False, and counted as rejected, if the
  /// size is negative or above largest() or the name is empty or too long.
  bool commit(std::string_view channel, int size) noexcept;

  /// Publishing thread: oldest record, valid until the next call; nullptr if empty.
  const Record* take() noexcept { return ring_.take(); }

  std::int64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
  std::int64_t rejected() const noexcept { return rejected_.load(std::memory_order_relaxed); }

 private:
  int largest_;
  HandoverRing<Record> ring_;
  std::atomic<std::int64_t> dropped_{0};
  std::atomic<std::int64_t> rejected_{0};
};

}  // namespace palpate::loop
