#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace palpate::math {

/// Seeded generator (xoshiro256++, Blackman and Vigna 2021) with identical numbers on every
/// machine: integer arithmetic, and floating-point operations that IEEE 754 rounds exactly.
class Random {
 public:
  /// Streams of one seed with different names are independent.
  explicit Random(std::uint64_t seed, std::string_view stream = "");

  /// Stream `name` derived from this one. Depends on seed and names only, not on numbers drawn so
  /// far.
  Random split(std::string_view name) const { return Random(seed_, name); }

  std::uint64_t next() noexcept;

  /// Uniform in [0, 1), 53 bits.
  double uniform() noexcept;
  /// Uniform in [lower, upper).
  double uniform(double lower, double upper) noexcept;
  /// Uniform in {0, ..., count - 1}, without bias; count >= 1.
  std::uint64_t below(std::uint64_t count) noexcept;
  /// Normal with mean 0 and standard deviation 1.
  double normal() noexcept;

 private:
  std::uint64_t seed_;
  std::array<std::uint64_t, 4> state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace palpate::math
