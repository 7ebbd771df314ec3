#include "core/math/random.hpp"

#include <cmath>

#include "core/math/fnv1a.hpp"

namespace palpate::math {
namespace {

std::uint64_t rotate_left(std::uint64_t x, int bits) { return (x << bits) | (x >> (64 - bits)); }

std::uint64_t split_mix(std::uint64_t& state) {
  std::uint64_t z = state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// Natural logarithm for 0 < x < 1 by arithmetic operations only, because the rounding of libm
/// differs between processors. Relative error below 1e-15.
double portable_log(double x) {
  constexpr double kLog2 = 0.69314718055994530942;
  constexpr double kSqrtHalf = 0.70710678118654752440;
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < kSqrtHalf) {
    m *= 2;
    --exponent;
  }
  // log m = 2 artanh z, |z| < 0.172
  const double z = (m - 1) / (m + 1);
  const double z2 = z * z;
  double series = 0;
  for (int k = 21; k >= 1; k -= 2) series = series * z2 + 1.0 / k;
  return exponent * kLog2 + 2 * z * series;
}

}  // namespace

Random::Random(std::uint64_t seed, std::string_view stream) {
  std::uint64_t mixer = seed;
  seed_ = stream.empty() ? seed : split_mix(mixer) ^ Fnv1a().add(stream).value();
  mixer = seed_;
  for (std::uint64_t& word : state_) word = split_mix(mixer);
}

std::uint64_t Random::next() noexcept {
  const std::uint64_t result = rotate_left(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = rotate_left(state_[3], 45);
  return result;
}

double Random::uniform() noexcept { return static_cast<double>(next() >> 11) * 0x1p-53; }

double Random::uniform(double lower, double upper) noexcept {
  return lower + (upper - lower) * uniform();
}

std::uint64_t Random::below(std::uint64_t count) noexcept {
  // reject numbers above the last whole multiple of count
  const std::uint64_t excess = (~std::uint64_t{0} % count + 1) % count;
  std::uint64_t x = next();
  while (x > ~std::uint64_t{0} - excess) x = next();
  return x % count;
}

double Random::normal() noexcept {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  // Marsaglia's polar method
  double u = 0, v = 0, s = 0;
  do {
    u = 2 * uniform() - 1;
    v = 2 * uniform() - 1;
    s = u * u + v * v;
  } while (s >= 1 || s == 0);
  const double scale = std::sqrt(-2 * portable_log(s) / s);
  spare_ = v * scale;
  has_spare_ = true;
  return u * scale;
}

}  // namespace palpate::math
