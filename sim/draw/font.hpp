#pragma once

#include <array>
#include <cstdint>

namespace palpate::draw {

inline constexpr int kGlyphWidth = 5;
inline constexpr int kGlyphHeight = 7;

/// Columns from the left of a printable ASCII character, bit 0 on top; '?' for any other.
const std::array<std::uint8_t, kGlyphWidth>& glyph(char character);

}  // namespace palpate::draw
