#include "rt/bus/udpm_frame.hpp"

#include <algorithm>
#include <cstring>

namespace palpate::bus {
namespace {

constexpr char kShortMagic[] = {'L', 'C', '0', '2'};
constexpr char kFragmentMagic[] = {'L', 'C', '0', '3'};

}  // namespace

FrameKind parse_udpm_frame(const std::uint8_t* data, int size, UdpmFrame& frame) noexcept {
  if (size < kUdpmHeaderSize) return FrameKind::kMalformed;
  if (std::memcmp(data, kFragmentMagic, sizeof(kFragmentMagic)) == 0) return FrameKind::kFragment;
  if (std::memcmp(data, kShortMagic, sizeof(kShortMagic)) != 0) return FrameKind::kMalformed;

  const std::uint8_t* name = data + kUdpmHeaderSize;
  const int searched = std::min(size - kUdpmHeaderSize, kLongestChannel + 1);
  const void* zero = std::memchr(name, 0, static_cast<std::size_t>(searched));
  if (zero == nullptr || zero == name) return FrameKind::kMalformed;
  const auto length = static_cast<int>(static_cast<const std::uint8_t*>(zero) - name);
  frame.channel = {reinterpret_cast<const char*>(name), static_cast<std::size_t>(length)};
  frame.payload = name + length + 1;
  frame.payload_size = size - kUdpmHeaderSize - length - 1;
  return FrameKind::kMessage;
}

bool fits_one_datagram(const char* channel, int size) noexcept {
  const auto name = static_cast<int>(strnlen(channel, kLongestChannel + 1));
  if (name == 0 || name > kLongestChannel) return false;
  return size >= 0 && size <= kLargestShortMessage - name - 1;
}

}  // namespace palpate::bus
