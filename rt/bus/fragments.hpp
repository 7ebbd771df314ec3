#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "rt/bus/lcm_bus.hpp"

namespace palpate::bus {

/// Joins the fragments of messages that are larger than a datagram: after the magic number "LC03" a
/// sequence number, the size of the whole payload and the place of this part in it (32 bits each),
/// the number of the part and of all parts (16 bits each), all in network order, then, in part 0,
/// the zero-terminated channel name, then the part. Parts may arrive in any order and between those
/// of other senders. Memory is bounded: the parts of at most kMost incomplete messages are kept,
/// and the oldest is given up for another one. No datagram can cause an allocation, an exception,
/// or an access outside the received data and the bound.
class FragmentAssembler {
 public:
  static constexpr int kMost = 4;  // incomplete messages
  /// Parts of a message, at most. LCM's have 65 kB.
  static constexpr int kMostParts = 4096;

  /// `largest`: payload, bytes, 1 or more; larger messages are dropped.
  explicit FragmentAssembler(int largest);

  static bool is_fragment(const std::uint8_t* data, int size) noexcept;

  enum class Outcome { kPart, kWhole, kDropped };
  /// Takes a datagram that is a fragment. `sender`: address of its sender. kWhole: message() is
  /// complete, and valid until the next call. kDropped: malformed, too large, or inconsistent with
  /// parts before.
  Outcome take(const std::uint8_t* data, int size, std::uint64_t sender) noexcept;
  const UdpmFrame& message() const noexcept { return message_; }

 private:
  struct Part {
    std::uint32_t at = 0;
    std::uint32_t size = 0;
    bool is_there = false;
  };
  struct Message {
    std::uint64_t sender = 0;
    std::uint32_t sequence = 0;
    std::uint32_t size = 0;
    int parts = 0;  // 0: unused
    int missing = 0;
    std::int64_t began = 0;  // count of messages
    std::array<char, kLongestChannel + 1> channel{};
    std::unique_ptr<Part[]> part;
    std::unique_ptr<std::uint8_t[]> payload;
  };
  Message& message_of(std::uint64_t sender, std::uint32_t sequence, std::uint32_t size,
                      int parts) noexcept;
  static bool is_contiguous(const Message& message) noexcept;

  std::uint32_t largest_;
  std::array<Message, kMost> messages_;
  std::int64_t begun_ = 0;
  UdpmFrame message_{};
};

}  // namespace palpate::bus
