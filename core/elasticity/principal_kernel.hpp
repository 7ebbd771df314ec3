#pragma once

#include <array>

#include "core/elasticity/point_kernel.hpp"
#include "core/elasticity/stretch_response.hpp"

// Hyperelastic points: F = R (I + E), E = V diag(e) V^T, principal stretches s_k = 1 + e_k. The
// smallest is negative where an element is inverted, as E is measured with the proper rotation R.
namespace palpate::elasticity {

/// Laws are continued below this stretch with the logarithm replaced by its tangent, so that an
/// element that is flat or inverted has a finite energy that drives it back (after Stomakhin et al.
/// 2012).
inline constexpr double kSmallestStretch = 0.1;

/// Principal strains e and their axes V, columns, of the strain E of a point.
template <class N>
struct PrincipalAxes {
  PackVector<N> strain{};
  PackMatrix<N> axes{N{} + 1, N{}, N{}, N{}, N{} + 1, N{}, N{}, N{}, N{} + 1};
};

namespace detail {

/// V <- V (3 I - V^T V) / 2, which removes the rounding errors of many rotations; the identity for
/// axes that a strain which was not finite has left.
template <class Pack>
inline void orthonormalise(PackMatrix<Pack>& V) {
  const auto dot = [&](int i, int j) -> Pack {
    return V[i] * V[j] + V[3 + i] * V[3 + j] + V[6 + i] * V[6 + j];
  };
  const Pack half = math::splat<Pack>(0.5), one_and_half = math::splat<Pack>(1.5);
  const Pack x2 = dot(0, 0), y2 = dot(1, 1), z2 = dot(2, 2);
  const Pack xx = one_and_half - half * x2, yy = one_and_half - half * y2,
             zz = one_and_half - half * z2;
  const Pack xy = half * dot(0, 1), xz = half * dot(0, 2), yz = half * dot(1, 2);
  const auto sound = math::abs(x2 + y2 + z2 - 3) < math::splat<Pack>(0.1);
  for (int i = 0; i < 9; i += 3) {
    const Pack x = V[i], y = V[i + 1], z = V[i + 2];
    V[i] = sound ? x * xx - y * xy - z * xz : Pack{};
    V[i + 1] = sound ? y * yy - x * xy - z * yz : Pack{};
    V[i + 2] = sound ? z * zz - x * xz - y * yz : Pack{};
  }
  for (int k = 0; k < 9; k += 4) V[k] += sound ? Pack{} : Pack{} + 1;
}

/// V^T E V.
template <class Pack>
inline PackSymmetric<Pack> in_axes(const PackMatrix<Pack>& V, const PackSymmetric<Pack>& E) {
  std::array<PackVector<Pack>, 3> columns, images;
  for (int k = 0; k < 3; ++k) {
    columns[k] = {V[k], V[3 + k], V[6 + k]};
    images[k] = times(E, columns[k]);
  }
  const auto dot = [&](int i, int j) -> Pack {
    return columns[i][0] * images[j][0] + columns[i][1] * images[j][1] +
           columns[i][2] * images[j][2];
  };
  return {dot(0, 0), dot(1, 1), dot(2, 2), dot(0, 1), dot(0, 2), dot(1, 2)};
}

/// Jacobi rotation of A and V that zeroes the component pq of A.
template <int p, int q, class Pack>
inline void turn_axes(PackSymmetric<Pack>& A, PackMatrix<Pack>& V) {
  constexpr int pq = p + q + 2, r = 3 - p - q, rp = r + p + 2, rq = r + q + 2;
  // squares of numbers below this one vanish
  const Pack tiny = math::splat<Pack>(sizeof(A[0][0]) == 4 ? 1e-18 : 1e-150);
  const Pack d = A[q] - A[p], b = A[pq] + A[pq];
  const Pack t = (d < 0 ? -b : b) / (math::abs(d) + math::sqrt(d * d + b * b) + tiny);
  const Pack c = 1 / math::sqrt(1 + t * t), s = t * c;
  A[p] -= t * A[pq];
  A[q] += t * A[pq];
  A[pq] = Pack{};
  const Pack arp = A[rp], arq = A[rq];
  A[rp] = c * arp - s * arq;
  A[rq] = s * arp + c * arq;
  for (int i = 0; i < 9; i += 3) {
    const Pack vp = V[i + p], vq = V[i + q];
    V[i + p] = c * vp - s * vq;
    V[i + q] = s * vp + c * vq;
  }
}

}  // namespace detail

/// Principal axes at `kCount` points by Jacobi's method, from those of the last strains or the
/// identity, all points in succession in each stage as in update_rotations().
template <class Pack, std::size_t kCount>
inline void find_principal_axes(const std::array<PointState<Pack>, kCount>& state,
                                std::array<PrincipalAxes<Pack>, kCount>& found) noexcept {
  constexpr int kMostSweeps = 8;
  const double rounding = sizeof(state[0].strain[0][0]) == 4 ? 3e-8 : 1e-15;
  const Pack smallest = math::splat<Pack>(rounding * rounding);
  std::array<PackSymmetric<Pack>, kCount> A;
  for (std::size_t p = 0; p < kCount; ++p) {
    detail::orthonormalise(found[p].axes);
    A[p] = detail::in_axes(found[p].axes, state[p].strain);
  }
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    Pack off{};
    for (std::size_t p = 0; p < kCount; ++p) {
      const Pack squares = A[p][3] * A[p][3] + A[p][4] * A[p][4] + A[p][5] * A[p][5];
      off = squares > off ? squares : off;
    }
    if (math::all(off <= smallest)) break;
    for (std::size_t p = 0; p < kCount; ++p) detail::turn_axes<0, 1>(A[p], found[p].axes);
    for (std::size_t p = 0; p < kCount; ++p) detail::turn_axes<0, 2>(A[p], found[p].axes);
    for (std::size_t p = 0; p < kCount; ++p) detail::turn_axes<1, 2>(A[p], found[p].axes);
  }
  for (std::size_t p = 0; p < kCount; ++p) found[p].strain = {A[p][0], A[p][1], A[p][2]};
}

/// Response to the principal stretches s_k.
template <class N>
struct PrincipalResponse {
  /// mu, lambda: in Pa, or times a volume.
  PrincipalResponse(const StretchLaw& law, N mu, N lambda, const PackVector<N>& strain) {
    std::array<N, 3> x;
    const N lowest = math::splat<N>(kSmallestStretch - 1);
    for (int k = 0; k < 3; ++k) {
      const N held = strain[k] < lowest ? lowest : strain[k];
      stretch[k] = 1 + strain[k];
      const N inverse = 1 / ((1 + held) * (2 + held));
      by_stretch[k] = (2 + held) * inverse;
      x[k] = log_stretch(held, held * (1 + held) * inverse) + (strain[k] - held) * by_stretch[k];
    }
    by_logarithm = respond(law, mu, lambda, x);
    for (int k = 0; k < 3; ++k) stress[k] = by_logarithm.stress[k] * by_stretch[k];
  }

  N energy() const { return by_logarithm.energy; }

  PackVector<N> stretch, stress;  // stress: dPsi/ds_k, principal Biot stress
  PackVector<N> by_stretch;       // dx_k/ds_k
  StretchResponse<N> by_logarithm;
};

/// Derivative of the first Piola-Kirchhoff stress in principal axes, i.e. of (R V)^T P V by
/// D = (R V)^T dF V:  dP_ii = sum_k hessian_ik D_kk, dP_ij = same_ij D_ij + crossed_ij D_ji.
template <class N>
struct PrincipalTangent {
  explicit PrincipalTangent(const PrincipalResponse<N>& r) {
    const N smallest = math::splat<N>(kSmallestStretch);
    const auto& H = r.by_logarithm.tangent;
    for (int k = 0; k < 3; ++k) {
      // below the smallest stretch the logarithm has no second derivative
      const N curved = r.stretch[k] < smallest ? N{} : r.stress[k] * r.by_stretch[k];
      hessian[k] = H[k] * r.by_stretch[k] * r.by_stretch[k] - curved;
    }
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3, ij = 5 - k;
      hessian[ij] = H[ij] * r.by_stretch[i] * r.by_stretch[j];
      // A rotation of the stretch's axes, and one of the stretch. Where stretches meet, the limit;
      // where they cancel and the rotation is not stable, a bound.
      const N apart = r.stretch[i] - r.stretch[j], together = r.stretch[i] + r.stretch[j];
      const N near = math::splat<N>(1e-5), least = math::splat<N>(kSmallestTurnStiffness);
      const N one = math::splat<N>(1);
      const auto meet = math::abs(apart) < near;
      const N limit = math::splat<N>(0.5) * (hessian[i] + hessian[j]) - hessian[ij];
      axes[k] = meet ? limit : (r.stress[i] - r.stress[j]) / (meet ? one : apart);
      turn[k] = (r.stress[i] + r.stress[j]) / (together < least ? least : together);
    }
  }

  /// Component ij, k being the third axis.
  N same(int k) const { return math::splat<N>(0.5) * (axes[k] + turn[k]); }
  N crossed(int k) const { return math::splat<N>(0.5) * (axes[k] - turn[k]); }

  PackSymmetric<N> hessian;  // d2Psi / ds_k ds_l
  PackVector<N> axes, turn;  // stiffness against symmetric and antisymmetric D_ij, by third axis
};

/// V diag(d) V^T.
template <class N>
inline PackSymmetric<N> from_principal(const PackMatrix<N>& V, const PackVector<N>& d) {
  PackSymmetric<N> A{};
  for (int k = 0; k < 3; ++k) {
    const N x = V[k] * d[k], y = V[3 + k] * d[k], z = V[6 + k] * d[k];
    A[0] += x * V[k];
    A[1] += y * V[3 + k];
    A[2] += z * V[6 + k];
    A[3] += x * V[3 + k];
    A[4] += x * V[6 + k];
    A[5] += y * V[6 + k];
  }
  return A;
}

/// Stress of StretchLaw, for add_stress().
struct HyperelasticStress {
  template <class Pack>
  using Axes = PrincipalAxes<Pack>;

  template <class Pack, std::size_t kCount>
  void prepare(const std::array<PointState<Pack>, kCount>& state,
               std::array<Axes<Pack>, kCount>& axes) const noexcept {
    find_principal_axes(state, axes);
  }

  template <class Pack>
  Pack evaluate(Pack mu, Pack lambda, const PackSymmetric<Pack>&, const Axes<Pack>& at,
                PackMatrix<Pack>& T) const noexcept {
    const PrincipalResponse<Pack> r(law, mu, lambda, at.strain);
    const PackSymmetric<Pack> B = from_principal(at.axes, r.stress);
    T = {B[0], B[3], B[4], B[3], B[1], B[5], B[4], B[5], B[2]};
    return r.energy();
  }

  StretchLaw law;
};

}  // namespace palpate::elasticity
