#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include "rt/bus/lcm_bus.hpp"

namespace palpate::bus {

/// Joins the fragments of messages that are sent in several datagrams: after the magic number
/// "LC03" a sequence number, the size of the whole payload and the place of this part in it (32
/// bits each), the number of the part and of all parts (16 bits each), all in network order, then,
/// in part 0, the zero-terminated channel name, then the part. Parts may arrive in any order and
/// between those of other senders. Memory is bounded and allocated by the constructor: the parts of
/// at most kMost incomplete messages are kept, and the oldest is given up for another one. No
/// datagram can cause an allocation, an exception, or an access outside the received data and the
/// bound.
class FragmentAssembler {
 public:
  static constexpr int kMost = 4;  // incomplete messages
  /// Parts of a message, at most. LCM's have 65 kB, those of its macOS version 1423 bytes.
  static constexpr int kMostParts = 4096;
  /// From the first received part of a message to its last, ns. After that it is given up.
  static constexpr std::int64_t kLongest = 1'000'000'000;

  /// `largest`: payload, bytes, 1 or more; larger messages are dropped.
  explicit FragmentAssembler(int largest);

  static bool is_fragment(const std::uint8_t* data, int size) noexcept;

  /// Takes a datagram that is a fragment, and counts it as received. `sender`: address of its
  /// sender. `arrival_ns`: CLOCK_MONOTONIC. True if it completes a message, which `frame` then is,
  /// valid until the next call. Counts as `fragmented` what is dropped: a fragment that is
  /// malformed, received twice, or of a message beyond the bounds, and all parts of a message that
  /// overlap or leave a gap, or that is given up.
  bool take(const std::uint8_t* data, int size, std::uint64_t sender, std::int64_t arrival_ns,
            DatagramCounters& counters, UdpmFrame& frame) noexcept;

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
    std::int64_t began_ns = 0;
    std::array<char, kLongestChannel + 1> channel{};
    std::unique_ptr<Part[]> part;
    std::unique_ptr<std::uint8_t[]> payload;
  };
  /// The message with the received part that completes it; nullptr if it is still incomplete or the
  /// part was dropped.
  Message* joined(const std::uint8_t* data, int size, std::uint64_t sender, std::int64_t arrival_ns,
                  std::int64_t& dropped) noexcept;
  Message& message_of(std::uint64_t sender, std::uint32_t sequence, std::uint32_t size, int parts,
                      std::int64_t arrival_ns, std::int64_t& dropped) noexcept;
  /// Frees the memory of an incomplete message. Returns the number of its received parts.
  static int give_up(Message& message) noexcept;
  static bool is_contiguous(const Message& message) noexcept;

  std::uint32_t largest_;
  std::array<Message, kMost> messages_;
};

}  // namespace palpate::bus
