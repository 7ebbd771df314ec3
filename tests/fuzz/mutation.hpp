#pragma once

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>

namespace palpate::fuzz {

/// A number from the environment, or `otherwise`.
inline long setting(const char* name, long otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::max(1L, std::atol(text));
}

/// Typical damage of files; deterministic for a seed, never none.
inline std::string damaged(std::string bytes, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::string whole = bytes;
  const auto place = [&] { return random() % bytes.size(); };
  // Half of the positions are near an end, where archives keep their directory.
  const auto end_place = [&] {
    const std::size_t near = random() % std::min<std::size_t>(bytes.size(), 1500);
    return random() % 2 == 0 ? place() : bytes.size() - 1 - near;
  };
  switch (random() % 8) {
    case 0:
      bytes[end_place()] ^= static_cast<char>(1u << random() % 8);
      break;
    case 1:
      for (int i = 0; i < 20; ++i) bytes[place()] ^= static_cast<char>(1u << random() % 8);
      break;
    case 2:
      bytes.resize(place());
      break;
    case 3:  // the last few bytes are missing
      bytes.resize(bytes.size() - std::min<std::size_t>(bytes.size(), 1 + random() % 100));
      break;
    case 4: {  // random noise
      const std::size_t begin = end_place();
      const std::size_t end = std::min(bytes.size(), begin + 1 + random() % 200);
      for (std::size_t i = begin; i < end; ++i) bytes[i] = static_cast<char>(random());
      break;
    }
    case 5: {  // a sector of zeros
      const std::size_t begin = place() / 512 * 512;
      std::fill(bytes.begin() + static_cast<long>(begin),
                bytes.begin() + static_cast<long>(std::min(bytes.size(), begin + 512)), '\0');
      break;
    }
    case 6: {  // a duplicated part
      const std::size_t begin = place();
      bytes.insert(place(), bytes.substr(begin, 1 + random() % 300));
      break;
    }
    default:  // sizes that are huge or negative
      for (int i = 0; i < 3; ++i) {
        const std::size_t begin = end_place();
        const char value = random() % 2 == 0 ? '\xff' : '\x7f';
        for (std::size_t k = begin; k < std::min(bytes.size(), begin + 4); ++k) bytes[k] = value;
      }
  }
  return bytes == whole ? damaged(whole, seed + 0x9e3779b97f4a7c15u) : bytes;
}

}  // namespace palpate::fuzz
