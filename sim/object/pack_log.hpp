#pragma once

#include <cstdint>
#include <cstring>

#include "core/math/pack.hpp"

namespace palpate::object {

/// Logarithm and reciprocal of positive normal numbers, sharing one division.
struct LogAndInverse {
  math::Pack4d log, inverse;
};

/// Per lane, accurate to about two units in the last place of the result: x = 2^k m with m in
/// [sqrt(1/2), sqrt(2)), log m = 2 artanh(s), s = (m - 1) / (m + 1).
inline LogAndInverse log_and_inverse(math::Pack4d x) noexcept {
  using Bits = std::uint64_t __attribute__((vector_size(32)));
  constexpr std::uint64_t kOne = 0x3ff0000000000000;       // bits of 1
  constexpr std::uint64_t kRootHalf = 0x3fe6a09e00000000;  // of sqrt(1/2), nearly
  constexpr std::uint64_t kMantissa = 0x000fffffffffffff;
  constexpr std::uint64_t kTwo52 = 0x4330000000000000;  // of 2^52: adding n to them adds n to it
  constexpr double kLog2High = 0x1.62e42feep-1;         // log 2 in two parts: k times the first one
  constexpr double kLog2Low = 0x1.a39ef35793c76p-33;    // is exact

  Bits bits;
  std::memcpy(&bits, &x, sizeof(bits));
  bits += kOne - kRootHalf;
  const Bits biased = (bits >> 52) + kTwo52;
  const Bits reduced = (bits & kMantissa) + kRootHalf;
  math::Pack4d k, m;
  std::memcpy(&k, &biased, sizeof(k));
  std::memcpy(&m, &reduced, sizeof(m));
  k -= 0x1p52 + 1023;

  // log(1 + f) = f - f^2/2 + s (f^2/2 + r) with r = 2 (artanh(s) / s - 1); s^2 < 0.0295.
  const math::Pack4d f = m - 1;
  const math::Pack4d both = 1 / (x * (2 + f));
  const math::Pack4d s = f * (both * x);
  const math::Pack4d z = s * s, z2 = z * z, z4 = z2 * z2;
  const math::Pack4d low = (2. / 3 + 2. / 5 * z) + (2. / 7 + 2. / 9 * z) * z2;
  const math::Pack4d high = (2. / 11 + 2. / 13 * z) + (2. / 15 + 2. / 17 * z) * z2;
  const math::Pack4d r = z * (low + (high + (2. / 19 + 2. / 21 * z) * z4) * z4);
  const math::Pack4d half_square = 0.5 * f * f;
  const math::Pack4d log_m = f - (half_square - (s * (half_square + r) + k * kLog2Low));
  return {k * kLog2High + log_m, both * (2 + f)};
}

}  // namespace palpate::object
