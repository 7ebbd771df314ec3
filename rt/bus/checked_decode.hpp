#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <palpate/contacts_t.hpp>
#include <palpate/health_t.hpp>
#include <palpate/shape_mesh_t.hpp>
#include <palpate/shape_mesh_v1_t.hpp>
#include <palpate/shape_t.hpp>
#include <palpate/shape_v1_t.hpp>

namespace palpate::bus {

/// For encoded types with variable arrays, all of 4-byte numbers: number of bytes before each
/// array's count, from the end of the previous array or of the fingerprint.
template <class Message>
inline constexpr std::array<int, 0> kBeforeCounts{};
template <>
inline constexpr std::array<int, 2> kBeforeCounts<shape_t>{56, 0};
template <>
inline constexpr std::array<int, 2> kBeforeCounts<shape_v1_t>{48, 0};
template <>
inline constexpr std::array<int, 4> kBeforeCounts<shape_mesh_t>{52, 4, 0, 0};
template <>
inline constexpr std::array<int, 4> kBeforeCounts<shape_mesh_v1_t>{52, 4, 0, 0};

/// True if `size` bytes match exactly the counts they contain. Generated code allocates as many
/// numbers as a count announces before it checks for them, and reads beyond the end if their size
/// exceeds an int.
template <class Message>
bool counts_fit(const std::uint8_t* data, std::int64_t size) noexcept {
  std::int64_t place = 0;
  for (const int before : kBeforeCounts<Message>) {
    place += before;
    if (place + 4 > size) return false;
    std::uint32_t big_endian = 0;
    std::memcpy(&big_endian, data + place, sizeof(big_endian));
    const auto count = static_cast<std::int32_t>(__builtin_bswap32(big_endian));
    if (count < 0) return false;
    place += 4 + std::int64_t{4} * count;
  }
  return place == size;
}

/// Decodes one complete message from untrusted bytes. False if it has another type or size.
template <class Message>
bool checked_decode(Message& message, const void* data, int size) {
  if (size < 8) return false;
  if constexpr (!kBeforeCounts<Message>.empty()) {
    if (!counts_fit<Message>(static_cast<const std::uint8_t*>(data), size)) return false;
  }
  return message.decode(data, 0, size) == size;
}

/// The same for messages that may be from a log: of the present type, or of a former type of that
/// name (docs/messages.md), which is converted. Former contacts are without predicted ones. Former
/// shapes and meshes contain the corner nodes only: the elements of such a mesh have 4 nodes,
/// whatever its element_kind. False if the
/// message has another type or size.
template <class Message>
bool decode(Message& message, const void* data, int size) {
  return checked_decode(message, data, size);
}
bool decode(contacts_t& message, const void* data, int size);
bool decode(health_t& message, const void* data, int size);
bool decode(shape_t& message, const void* data, int size);
bool decode(shape_mesh_t& message, const void* data, int size);

}  // namespace palpate::bus
