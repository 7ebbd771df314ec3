#pragma once

#include "core/elasticity/point_kernel.hpp"

// Transfer between nodal fields, four numbers per node of which the last is padding, and packs that
// hold one coordinate of a node of each of several elements. Nodes are given by their offset in the
// field, four times their number.
namespace palpate::elasticity {

/// d = x[offsets] - x[origins] in each lane. The difference is computed before rounding to the
/// lanes' type, so that positions far from the origin lose no accuracy.
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

/// field[offsets] += f, lane by lane, because the same node may occur in several.
template <class Pack>
inline void scatter_add(const PackVector<Pack>& f, const int* offsets,
                        typename math::PackTraits<Pack>::Real* field) {
  for (int lane = 0; lane < math::kLanes<Pack>; ++lane) {
    for (int c = 0; c < 3; ++c) field[offsets[lane] + c] += f[c][lane];
  }
}

/// q[k] = field[offsets + k] in each lane.
template <class Pack>
inline void gather(const float* field, const int* offsets, std::array<Pack, 4>& q) {
  using Real = typename math::PackTraits<Pack>::Real;
  for (int lane = 0; lane < math::kLanes<Pack>; ++lane) {
    for (int k = 0; k < 4; ++k) q[k][lane] = static_cast<Real>(field[offsets[lane] + k]);
  }
}

/// field[offsets + k] += q[k], lane by lane.
template <class Pack>
inline void scatter_add(const std::array<Pack, 4>& q, const int* offsets, float* field) {
  for (int lane = 0; lane < math::kLanes<Pack>; ++lane) {
    for (int k = 0; k < 4; ++k) field[offsets[lane] + k] += static_cast<float>(q[k][lane]);
  }
}

#if defined(__AVX2__)
namespace detail {

inline __m256d difference(const double* x, int offset, int origin) {
  return _mm256_loadu_pd(x + offset) - _mm256_loadu_pd(x + origin);
}

inline void add_to(double* to, __m256d f) { _mm256_storeu_pd(to, _mm256_loadu_pd(to) + f); }
inline void add_to(float* to, __m128 f) { _mm_storeu_ps(to, _mm_loadu_ps(to) + f); }

inline void transpose(std::array<math::Pack4d, 4>& r) {
  const __m256d a = _mm256_unpacklo_pd(r[0], r[1]), b = _mm256_unpackhi_pd(r[0], r[1]);
  const __m256d c = _mm256_unpacklo_pd(r[2], r[3]), e = _mm256_unpackhi_pd(r[2], r[3]);
  r = {_mm256_permute2f128_pd(a, c, 0x20), _mm256_permute2f128_pd(b, e, 0x20),
       _mm256_permute2f128_pd(a, c, 0x31), _mm256_permute2f128_pd(b, e, 0x31)};
}

/// Transposes the 4 x 4 numbers in the lower halves and those in the upper halves.
inline void transpose(std::array<math::Pack8f, 4>& r) {
  const __m256 a = _mm256_unpacklo_ps(r[0], r[1]), b = _mm256_unpackhi_ps(r[0], r[1]);
  const __m256 c = _mm256_unpacklo_ps(r[2], r[3]), e = _mm256_unpackhi_ps(r[2], r[3]);
  r = {_mm256_shuffle_ps(a, c, 0x44), _mm256_shuffle_ps(a, c, 0xee), _mm256_shuffle_ps(b, e, 0x44),
       _mm256_shuffle_ps(b, e, 0xee)};
}

inline __m256 join(__m128 low, __m128 high) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(low), high, 1);
}

}  // namespace detail

template <>
inline void gather_difference(const double* x, const int* offsets, const int* origins,
                              PackVector<math::Pack4d>& d) {
  std::array<math::Pack4d, 4> r;
  for (int k = 0; k < 4; ++k) r[k] = detail::difference(x, offsets[k], origins[k]);
  detail::transpose(r);
  d = {r[0], r[1], r[2]};
}

template <>
inline void scatter_add(const PackVector<math::Pack4d>& f, const int* offsets, double* field) {
  std::array<math::Pack4d, 4> r{f[0], f[1], f[2], math::Pack4d{}};
  detail::transpose(r);
  for (int k = 0; k < 4; ++k) detail::add_to(field + offsets[k], r[k]);
}

template <>
inline void gather(const float* field, const int* offsets, std::array<math::Pack4d, 4>& q) {
  for (int k = 0; k < 4; ++k) q[k] = _mm256_cvtps_pd(_mm_loadu_ps(field + offsets[k]));
  detail::transpose(q);
}

template <>
inline void scatter_add(const std::array<math::Pack4d, 4>& q, const int* offsets, float* field) {
  std::array<math::Pack4d, 4> r = q;
  detail::transpose(r);
  for (int k = 0; k < 4; ++k) detail::add_to(field + offsets[k], _mm256_cvtpd_ps(r[k]));
}

template <>
inline void gather_difference(const double* x, const int* offsets, const int* origins,
                              PackVector<math::Pack8f>& d) {
  std::array<math::Pack8f, 4> r;  // lanes k and k + 4
  for (int k = 0; k < 4; ++k) {
    r[k] = detail::join(_mm256_cvtpd_ps(detail::difference(x, offsets[k], origins[k])),
                        _mm256_cvtpd_ps(detail::difference(x, offsets[k + 4], origins[k + 4])));
  }
  detail::transpose(r);
  d = {r[0], r[1], r[2]};
}

template <>
inline void gather(const float* field, const int* offsets, std::array<math::Pack8f, 4>& q) {
  for (int k = 0; k < 4; ++k) {
    q[k] = detail::join(_mm_loadu_ps(field + offsets[k]), _mm_loadu_ps(field + offsets[k + 4]));
  }
  detail::transpose(q);
}

template <>
inline void scatter_add(const std::array<math::Pack8f, 4>& q, const int* offsets, float* field) {
  std::array<math::Pack8f, 4> r = q;
  detail::transpose(r);
  for (int k = 0; k < 4; ++k) {
    detail::add_to(field + offsets[k], _mm256_castps256_ps128(r[k]));
  }
  for (int k = 0; k < 4; ++k) {
    detail::add_to(field + offsets[k + 4], _mm256_extractf128_ps(r[k], 1));
  }
}

template <>
inline void scatter_add(const PackVector<math::Pack8f>& f, const int* offsets, float* field) {
  scatter_add(std::array<math::Pack8f, 4>{f[0], f[1], f[2], math::Pack8f{}}, offsets, field);
}
#endif

}  // namespace palpate::elasticity
