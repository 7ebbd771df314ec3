#pragma once

#include "core/elasticity/point_kernel.hpp"

// Between nodal fields, four numbers a node of which the last is padding, and packs that hold one
// coordinate of a node of each of several elements. Nodes are named by their offset in the field,
// four times their number.
namespace palpate::elasticity {

/// d = x[offsets] - x[origins], lane by lane. The difference is taken before rounding to the lanes'
/// type, so that a body far from the origin loses nothing.
template <class Pack>
inline void gather_difference(const double* x, const int* offsets, const int* origins,
                              PackVector<Pack>& d) {
  using Real = typename math::PackTraits<Pack>::Real;
  for (int lane = 0; lane < math::kLanes<Pack>; ++lane) {
    for (int c = 0; c < 3; ++c) {
      d[c][lane] = static_cast<Real>(x[offsets[lane] + c] - x[origins[lane] + c]);
    }
  }
}

/// field[offsets] += f, lane after lane: the same node may stand in several.
template <class Pack>
inline void scatter_add(const PackVector<Pack>& f, const int* offsets,
                        typename math::PackTraits<Pack>::Real* field) {
  for (int lane = 0; lane < math::kLanes<Pack>; ++lane) {
    for (int c = 0; c < 3; ++c) field[offsets[lane] + c] += f[c][lane];
  }
}

#if defined(__AVX2__)
namespace detail {

inline __m256d difference(const double* x, int offset, int origin) {
  return _mm256_loadu_pd(x + offset) - _mm256_loadu_pd(x + origin);
}

inline void add_to(double* to, __m256d f) { _mm256_storeu_pd(to, _mm256_loadu_pd(to) + f); }
inline void add_to(float* to, __m128 f) { _mm_storeu_ps(to, _mm_loadu_ps(to) + f); }

}  // namespace detail

template <>
inline void gather_difference(const double* x, const int* offsets, const int* origins,
                              PackVector<math::Pack4d>& d) {
  __m256d r[4];
  for (int lane = 0; lane < 4; ++lane) {
    r[lane] = detail::difference(x, offsets[lane], origins[lane]);
  }
  const __m256d a = _mm256_unpacklo_pd(r[0], r[1]), b = _mm256_unpackhi_pd(r[0], r[1]);
  const __m256d c = _mm256_unpacklo_pd(r[2], r[3]), e = _mm256_unpackhi_pd(r[2], r[3]);
  d = {_mm256_permute2f128_pd(a, c, 0x20), _mm256_permute2f128_pd(b, e, 0x20),
       _mm256_permute2f128_pd(a, c, 0x31)};
}

template <>
inline void scatter_add(const PackVector<math::Pack4d>& f, const int* offsets, double* field) {
  const __m256d zero = _mm256_setzero_pd();
  const __m256d a = _mm256_unpacklo_pd(f[0], f[1]), b = _mm256_unpackhi_pd(f[0], f[1]);
  const __m256d c = _mm256_unpacklo_pd(f[2], zero), e = _mm256_unpackhi_pd(f[2], zero);
  detail::add_to(field + offsets[0], _mm256_permute2f128_pd(a, c, 0x20));
  detail::add_to(field + offsets[1], _mm256_permute2f128_pd(b, e, 0x20));
  detail::add_to(field + offsets[2], _mm256_permute2f128_pd(a, c, 0x31));
  detail::add_to(field + offsets[3], _mm256_permute2f128_pd(b, e, 0x31));
}

template <>
inline void gather_difference(const double* x, const int* offsets, const int* origins,
                              PackVector<math::Pack8f>& d) {
  __m256 r[4];  // lanes k and k + 4
  for (int k = 0; k < 4; ++k) {
    const __m128 low = _mm256_cvtpd_ps(detail::difference(x, offsets[k], origins[k]));
    const __m128 high = _mm256_cvtpd_ps(detail::difference(x, offsets[k + 4], origins[k + 4]));
    r[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(low), high, 1);
  }
  const __m256 a = _mm256_unpacklo_ps(r[0], r[1]), b = _mm256_unpackhi_ps(r[0], r[1]);
  const __m256 c = _mm256_unpacklo_ps(r[2], r[3]), e = _mm256_unpackhi_ps(r[2], r[3]);
  d = {_mm256_shuffle_ps(a, c, 0x44), _mm256_shuffle_ps(a, c, 0xee), _mm256_shuffle_ps(b, e, 0x44)};
}

template <>
inline void scatter_add(const PackVector<math::Pack8f>& f, const int* offsets, float* field) {
  const __m256 zero = _mm256_setzero_ps();
  const __m256 a = _mm256_unpacklo_ps(f[0], f[1]), b = _mm256_unpackhi_ps(f[0], f[1]);
  const __m256 c = _mm256_unpacklo_ps(f[2], zero), e = _mm256_unpackhi_ps(f[2], zero);
  const __m256 r[4] = {_mm256_shuffle_ps(a, c, 0x44), _mm256_shuffle_ps(a, c, 0xee),
                       _mm256_shuffle_ps(b, e, 0x44), _mm256_shuffle_ps(b, e, 0xee)};
  for (int k = 0; k < 4; ++k) {
    detail::add_to(field + offsets[k], _mm256_castps256_ps128(r[k]));
  }
  for (int k = 0; k < 4; ++k) {
    detail::add_to(field + offsets[k + 4], _mm256_extractf128_ps(r[k], 1));
  }
}
#endif

}  // namespace palpate::elasticity
