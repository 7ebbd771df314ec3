#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::loop {

/// Bounded FIFO hand-over of slots from one producer to one consumer. If it is full, publishing
/// drops the oldest slot. The producer is wait-free, the consumer lock-free; nothing allocates
/// after construction.
///
/// There are `depth` cells and depth + 2 slots. At any time each slot is owned by exactly one of
/// the producer (its back slot), the consumer (the slot last taken) or one cell, and ownership
/// changes only by an atomic read-modify-write of a cell:
/// - Publication number n (from 1) exchanges cell n mod depth: the back slot is stored marked full,
///   and the previous content of the cell becomes the next back slot. If that was full, the oldest
///   slot has been dropped.
/// - The consumer, expecting number n, compare-exchanges cell n mod depth from (n, full) to (n,
///   empty) with the slot it has finished with. This fails only if the producer has meanwhile
///   overwritten the cell with a number s > n; then all slots up to s - depth are lost and the
///   consumer continues with s - depth + 1, so that order is preserved and no slot is received
///   twice. Both steps are acquire-release, hence the new owner of a slot sees all writes of its
///   previous owner. A cell holds 48 bits of the number, so that a cell value recurs after 89 years
///   at 100 kHz.
template <class Slot>
class HandoverRing {
 public:
  /// Every slot is initialised as a copy of `prototype`. Throws std::invalid_argument unless 1 <=
  /// depth <= 30000.
  HandoverRing(int depth, const Slot& prototype) {
    if (depth < 1 || depth > kLargestDepth)
      throw std::invalid_argument("depth of a queue must be 1 to 30000, not " +
                                  std::to_string(depth));
    depth_ = static_cast<std::uint64_t>(depth);
    slots_.assign(depth_ + 2, prototype);
    cells_ = std::make_unique<std::atomic<std::uint64_t>[]>(depth_);
    for (std::uint64_t i = 0; i < depth_; ++i) cells_[i].store(pack(0, i, false));
    back_ = depth_;
    front_ = depth_ + 1;
  }

  /// Producer: slot to fill next.
  Slot& back() noexcept { return slots_[back_]; }

  /// Producer: publishes back(). True if the oldest slot was dropped.
  bool publish() noexcept {
    ++published_;
    const std::uint64_t old = cells_[published_ % depth_].exchange(pack(published_, back_, true),
                                                                   std::memory_order_acq_rel);
    back_ = slot_of(old);
    return is_full(old);
  }

  /// Consumer: oldest slot, valid until the next call; nullptr if empty.
  Slot* take() noexcept {
    for (;;) {
      std::atomic<std::uint64_t>& cell = cells_[expected_ % depth_];
      std::uint64_t seen = cell.load(std::memory_order_acquire);
      const std::uint64_t number = number_of(seen);
      if (number > expected_) {
        expected_ = number - depth_ + 1;
        continue;
      }
      if (number < expected_ || !is_full(seen)) return nullptr;
      if (!cell.compare_exchange_strong(seen, pack(expected_, front_, false),
                                        std::memory_order_acq_rel, std::memory_order_relaxed))
        continue;
      front_ = slot_of(seen);
      ++expected_;
      return &slots_[front_];
    }
  }

 private:
  static constexpr int kLargestDepth = 30000;
  static constexpr std::uint64_t pack(std::uint64_t number, std::uint64_t slot,
                                      bool full) noexcept {
    return number << 16 | slot << 1 | (full ? 1u : 0u);
  }
  static constexpr std::uint64_t number_of(std::uint64_t cell) noexcept { return cell >> 16; }
  static constexpr std::uint64_t slot_of(std::uint64_t cell) noexcept { return cell >> 1 & 0x7fff; }
  static constexpr bool is_full(std::uint64_t cell) noexcept { return (cell & 1) != 0; }

  std::uint64_t depth_ = 0;
  std::vector<Slot> slots_;
  std::unique_ptr<std::atomic<std::uint64_t>[]> cells_;
  // state of each side, on separate cache lines
  alignas(64) std::uint64_t back_ = 0;
  std::uint64_t published_ = 0;
  alignas(64) std::uint64_t front_ = 0;
  std::uint64_t expected_ = 1;
};

}  // namespace palpate::loop
