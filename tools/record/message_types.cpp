#include "tools/record/message_types.hpp"

#include <cstring>

namespace palpate::record {
namespace {

template <class Number>
Number big_endian(const void* data) noexcept {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) value = value << 8 | bytes[i];
  return static_cast<Number>(value);
}

}  // namespace

const MessageType* type_of(const void* data, int size) noexcept {
  if (size < kMessageHeaderSize) return nullptr;
  const auto fingerprint = big_endian<std::int64_t>(data);
  for (const MessageType& type : message_types()) {
    if (type.fingerprint == fingerprint) return &type;
  }
  return nullptr;
}

MessageHeader header_of(const void* data) noexcept {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  return {big_endian<std::int64_t>(bytes + 8), big_endian<std::int32_t>(bytes + 16),
          big_endian<std::int64_t>(bytes + 20)};
}

}  // namespace palpate::record
