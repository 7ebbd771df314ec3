#pragma once

#include <cstring>
#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace palpate::math {

/// Vector register of 256 bits (compiler vector extension): + - * / and comparisons are written as
/// for a scalar. A comparison yields a mask for select().
using Pack4d = double __attribute__((vector_size(32)));
using Pack8f = float __attribute__((vector_size(32)));

template <class Pack>
struct PackTraits;
template <>
struct PackTraits<Pack4d> {
  using Real = double;
  static constexpr int kLanes = 4;
};
template <>
struct PackTraits<Pack8f> {
  using Real = float;
  static constexpr int kLanes = 8;
};

template <class Pack>
inline constexpr int kLanes = PackTraits<Pack>::kLanes;

/// The same number in every lane.
template <class Pack>
inline Pack splat(double value) {
  return Pack{} + static_cast<typename PackTraits<Pack>::Real>(value);
}

/// Loads and stores four doubles at any alignment.
inline Pack4d load(const double* from) {
  Pack4d x;
  std::memcpy(&x, from, sizeof(x));
  return x;
}
inline void store(Pack4d x, double* to) { std::memcpy(to, &x, sizeof(x)); }

/// True if a comparison holds in every lane.
template <class Mask>
inline bool all(Mask mask) {
#if defined(__AVX__)
  static_assert(sizeof(Mask) == 32);
  return _mm256_movemask_epi8(reinterpret_cast<__m256i&>(mask)) == -1;
#else
  for (unsigned k = 0; k < sizeof(Mask) / sizeof(mask[0]); ++k) {
    if (mask[k] == 0) return false;
  }
  return true;
#endif
}

template <class Pack>
inline double sum(Pack x) {
  double total = 0;
  for (int k = 0; k < kLanes<Pack>; ++k) total += static_cast<double>(x[k]);
  return total;
}

}  // namespace palpate::math
