#pragma once

#include <cstdint>
#include <string_view>

namespace palpate::bus {

/// LCM's framing of a short message in one datagram: the magic number "LC02" and a sequence number,
/// 32 bits each in network order, the zero-terminated channel name, and the payload.
struct UdpmFrame {
  std::string_view channel;
  const std::uint8_t* payload;
  int payload_size;  // bytes
};

enum class FrameKind {
  kMessage,
  kFragment,  // "LC03": fragment of a message that did not fit into one datagram
  /// Too short, a different magic number, or a name that is empty, longer than 63 characters, or
  /// not terminated.
  kMalformed,
};

/// Parses untrusted data without reading beyond `size` bytes and without copying: the frame points
/// into `data`. The frame is set for kMessage only.
FrameKind parse_udpm_frame(const std::uint8_t* data, int size, UdpmFrame& frame) noexcept;

/// True if a message of `size` bytes fits into one datagram and the name has 1 to 63 characters.
bool fits_one_datagram(const char* channel, int size) noexcept;

inline constexpr int kUdpmHeaderSize = 8;
inline constexpr int kLongestChannel = 63;
/// Maximum size of name, terminating zero and payload in one datagram: the largest UDP payload
/// minus the header.
inline constexpr int kLargestShortMessage = 65507 - kUdpmHeaderSize;

}  // namespace palpate::bus
