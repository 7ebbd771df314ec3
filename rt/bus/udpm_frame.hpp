#pragma once

#include <cstdint>
#include <string_view>

namespace palpate::bus {

/// LCM's framing of a short message, one datagram: the magic "LC02" and a sequence number, each of
/// 32 bits in network order, the channel's name with its zero, and the payload.
struct UdpmFrame {
  std::string_view channel;
  const std::uint8_t* payload;
  int payload_size;  // bytes
};

enum class FrameKind {
  kMessage,
  kFragment,   // "LC03": part of a message that did not fit one datagram
  kMalformed,  // too short, another magic, or a name that is empty, longer than 63, or has no end
};

/// Looks at nothing beyond `size` bytes, trusts none of them, and copies none: the frame points
/// into `data`. The frame is set for kMessage only.
FrameKind parse_udpm_frame(const std::uint8_t* data, int size, UdpmFrame& frame) noexcept;

/// Whether a message of `size` bytes goes into one datagram, and the name is 1 to 63 characters
/// long.
bool fits_one_datagram(const char* channel, int size) noexcept;

inline constexpr int kUdpmHeaderSize = 8;
inline constexpr int kLongestChannel = 63;
/// Name, its zero and payload of a message in one datagram: the largest UDP payload less the
/// header.
inline constexpr int kLargestShortMessage = 65507 - kUdpmHeaderSize;

}  // namespace palpate::bus
