#pragma once

#include <cstdint>
#include <cstring>

#if defined(__AVX2__) && defined(__FMA__) && defined(__F16C__)
#include <immintrin.h>
#define PALPATE_HAS_HALF 1
#else
#define PALPATE_HAS_HALF 0
#endif

/// Products of a matrix stored in tiles of 8 rows with a vector. `Stored` is float or, where the
/// processor can convert it, std::uint16_t for half precision.
namespace palpate::factor::panel_kernel {

inline constexpr int kTile = 8;
inline constexpr int kGroup = 4;  // maximum number of interleaved tiles
inline constexpr bool kHasHalf = PALPATE_HAS_HALF;

inline int tiles_of(int rows) { return (rows + kTile - 1) / kTile; }
inline int padded(int rows) { return (tiles_of(rows) + kGroup - 1) / kGroup * kGroup * kTile; }

// Eight floats in one register, or in two or more where registers are smaller.
using Lanes = float __attribute__((vector_size(32)));

inline void load(const float* source, Lanes& lanes) { std::memcpy(&lanes, source, sizeof lanes); }
inline void store(const Lanes& lanes, float* target) { std::memcpy(target, &lanes, sizeof lanes); }
inline void encode(const Lanes& lanes, float* target) { store(lanes, target); }

#if PALPATE_HAS_HALF
inline void load(const std::uint16_t* source, Lanes& lanes) {
  __m128i halves;
  std::memcpy(&halves, source, sizeof halves);
  lanes = _mm256_cvtph_ps(halves);
}
inline void encode(const Lanes& lanes, std::uint16_t* target) {
  const __m128i halves = _mm256_cvtps_ph(lanes, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
  std::memcpy(target, &halves, sizeof halves);
}
#endif

/// y += A b, or y = A b if `first`, for kHeight interleaved tiles.
template <int kHeight, class Stored>
inline void multiply(const Stored* a, const float* b, int columns, bool first, float* y) {
  constexpr int kUnroll = 8 / kHeight;  // enough partial sums to hide the latency of an addition
  Lanes sums[kUnroll][kHeight], column;
  for (int u = 0; u < kUnroll; ++u) {
    for (int h = 0; h < kHeight; ++h) sums[u][h] = Lanes{};
  }
  int c = 0;
  for (; c + kUnroll <= columns; c += kUnroll) {
    for (int u = 0; u < kUnroll; ++u) {
      for (int h = 0; h < kHeight; ++h, a += kTile) {
        load(a, column);
        sums[u][h] += column * b[c + u];
      }
    }
  }
  for (; c < columns; ++c) {
    for (int h = 0; h < kHeight; ++h, a += kTile) {
      load(a, column);
      sums[0][h] += column * b[c];
    }
  }
  for (int h = 0; h < kHeight; ++h) {
    for (int u = 1; u < kUnroll; ++u) sums[0][h] += sums[u][h];
    if (!first) {
      load(y + h * kTile, column);
      sums[0][h] += column;
    }
    store(sums[0][h], y + h * kTile);
  }
}

/// sums += A^T x, before the eight lanes of each column's sum are added.
template <int kHeight, class Stored>
inline void multiply_transposed(const Stored* a, const float* x, int columns, float* sums) {
  Lanes rows[kHeight], column, sum;
  for (int h = 0; h < kHeight; ++h) load(x + h * kTile, rows[h]);
  for (int c = 0; c < columns; ++c) {
    load(sums + c * kTile, sum);
    for (int h = 0; h < kHeight; ++h, a += kTile) {
      load(a, column);
      sum += column * rows[h];
    }
    store(sum, sums + c * kTile);
  }
}

/// Adds the lanes of each of eight sums.
inline void add_lanes(const float* sums, float* totals) {
#if PALPATE_HAS_HALF
  __m256 s[8];
  for (int k = 0; k < 8; ++k) s[k] = _mm256_loadu_ps(sums + k * kTile);
  const __m256 low = _mm256_hadd_ps(_mm256_hadd_ps(s[0], s[1]), _mm256_hadd_ps(s[2], s[3]));
  const __m256 high = _mm256_hadd_ps(_mm256_hadd_ps(s[4], s[5]), _mm256_hadd_ps(s[6], s[7]));
  _mm256_storeu_ps(totals, _mm256_add_ps(_mm256_permute2f128_ps(low, high, 0x20),
                                         _mm256_permute2f128_ps(low, high, 0x31)));
#else
  for (int k = 0; k < 8; ++k) {
    totals[k] = 0;
    for (int l = 0; l < kTile; ++l) totals[k] += sums[k * kTile + l];
  }
#endif
}

}  // namespace palpate::factor::panel_kernel
