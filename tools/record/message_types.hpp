#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpate::record {

/// One of palpate's types, which all begin with utime, seq and session.
struct MessageType {
  std::string name;
  std::int64_t fingerprint = 0;
  int smallest = 0;  // encoded bytes with its fingerprint; all that it has where its size is fixed
  /// Whether `size` bytes, the fingerprint among them, can be decoded as this type; safe for any.
  bool (*fits)(const void* data, int size) = nullptr;
};

/// All of lcmtypes/, in alphabetical order.
const std::vector<MessageType>& message_types();

/// Of an encoded message; nullptr where it is none of ours.
const MessageType* type_of(const void* data, int size) noexcept;

/// What every type begins with.
struct MessageHeader {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  std::int64_t session = 0;
};
inline constexpr int kMessageHeaderSize = 28;  // with the fingerprint in front

/// Of a message of one of our types; `data` holds kMessageHeaderSize bytes at least.
MessageHeader header_of(const void* data) noexcept;

}  // namespace palpate::record
