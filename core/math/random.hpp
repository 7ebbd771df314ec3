#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace palpate::math {

/// Seeded generator (xoshiro256++, Blackman and Vigna 2021) that gives the same numbers on every
/// machine: integer arithmetic, and doubles by operations that IEEE 754 rounds exactly.
class Random {
 public:
  /// Streams of one seed with unlike names are independent of each other.
  explicit Random(std::uint64_t seed, std::string_view stream = "");

  /// The stream `name` below this one. Depends on seed and names alone, not on what was drawn.
  Random split(std::string_view name) const { return Random(seed_, name); }

  std::uint64_t next() noexcept;

  /// In [0, 1), 53 bits.
  double uniform() noexcept;
  /// In [lower, upper).
  double uniform(double lower, double upper) noexcept;
  /// In {0, ..., count - 1}, without bias; count at least 1.
  std::uint64_t below(std::uint64_t count) noexcept;
  /// Mean 0, standard deviation 1.
  double normal() noexcept;

 private:
  std::uint64_t seed_;
  std::array<std::uint64_t, 4> state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace palpate::math
