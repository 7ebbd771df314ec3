#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace palpate::bus {

/// Copies text into a char array of a message, truncated and zero-terminated.
template <std::size_t kSize>
void put_text(std::uint8_t (&field)[kSize], std::string_view text) noexcept {
  const std::size_t length = std::min(text.size(), kSize - 1);
  std::memcpy(field, text.data(), length);
  std::memset(field + length, 0, kSize - length);
}

template <std::size_t kSize>
void put_text(std::array<char, kSize>& field, std::string_view text) noexcept {
  const std::size_t length = std::min(text.size(), kSize - 1);
  std::copy_n(text.data(), length, field.begin());
  std::fill(field.begin() + length, field.end(), '\0');
}

/// Text of a char array; empty if it is not terminated.
template <std::size_t kSize>
const char* get_text(const std::uint8_t (&field)[kSize]) noexcept {
  return std::memchr(field, 0, kSize) != nullptr ? reinterpret_cast<const char*>(field) : "";
}

}  // namespace palpate::bus
