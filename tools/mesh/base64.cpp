#include "tools/mesh/base64.hpp"

#include <array>
#include <cctype>
#include <cstdint>
#include <stdexcept>

namespace palpate::mesh_tool {
namespace {

constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::array<int, 256> make_values() {
  std::array<int, 256> values{};
  values.fill(-1);
  for (int i = 0; i < 64; ++i) values[static_cast<unsigned char>(kLetters[i])] = i;
  return values;
}

}  // namespace

std::string to_base64(const std::string& bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? kLetters[bits >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

std::string from_base64(const std::string& text) {
  static const std::array<int, 256> kValues = make_values();
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0, padding = 0;
  for (const char c : text) {
    if (std::isspace(static_cast<unsigned char>(c)) != 0) continue;
    const int value = kValues[static_cast<unsigned char>(c)];
    if (c == '=' ? count < 2 : (value < 0 || padding > 0)) {
      throw std::runtime_error(std::string("'") + c + "' is no base64 here");
    }
    padding += c == '=' ? 1 : 0;
    bits = bits << 6 | (c == '=' ? 0U : static_cast<std::uint32_t>(value));
    if (++count < 4) continue;
    for (int k = 0; k < 3 - padding; ++k) bytes += static_cast<char>(bits >> (16 - 8 * k) & 255U);
    bits = 0;
    count = padding = 0;
  }
  if (count != 0) throw std::runtime_error("base64 ends within a group of four");
  return bytes;
}

}  // namespace palpate::mesh_tool
