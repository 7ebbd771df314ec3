#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "core/math/pack.hpp"
#include "core/math/polar.hpp"

// Operations at a quadrature point, for all lanes of a pack at once: polar decomposition, energy
// and stress.
namespace palpate::elasticity {

template <class Pack>
using PackMatrix = std::array<Pack, 9>;  // row-major
template <class Pack>
using PackSymmetric = std::array<Pack, 6>;  // xx yy zz xy xz yz
template <class Pack>
using PackVector = std::array<Pack, 3>;

/// State of points kept between evaluations: rotations R as unit quaternions (w x y z), the
/// starting points of the next search, and strain E = R^T F - I, now and at the beginning of the
/// time step.
template <class Pack>
struct PointState {
  std::array<Pack, 4> rotation{Pack{} + 1, Pack{}, Pack{}, Pack{}};
  PackSymmetric<Pack> strain{};
  PackSymmetric<Pack> previous_strain{};
};

namespace detail {

template <class Pack>
struct Inverse {
  PackSymmetric<Pack> adjugate;
  Pack determinant;
  decltype(Pack{} < Pack{}) positive;
};

/// Inverse of H = tr(S) I - S with S = I + E: the negative second derivative of tr(R^T F) with
/// respect to a rotation of R.
template <class Pack>
inline Inverse<Pack> invert_turn_stiffness(const PackSymmetric<Pack>& E) {
  const Pack xx = 2 + E[1] + E[2], yy = 2 + E[0] + E[2], zz = 2 + E[0] + E[1];
  const Pack xy = -E[3], xz = -E[4], yz = -E[5];
  Inverse<Pack> out;
  out.adjugate = {yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy,
                  xz * yz - xy * zz, xy * yz - xz * yy, xy * xz - xx * yz};
  out.determinant = xx * out.adjugate[0] + xy * out.adjugate[3] + xz * out.adjugate[4];
  out.positive = (xx > 0) & (out.adjugate[2] > 0) &
                 (out.determinant > math::splat<Pack>(sizeof(xx[0]) == 4 ? 1e-4 : 1e-9));
  return out;
}

template <class Pack>
inline PackVector<Pack> times(const PackSymmetric<Pack>& A, const PackVector<Pack>& v) {
  return {A[0] * v[0] + A[3] * v[1] + A[4] * v[2], A[3] * v[0] + A[1] * v[1] + A[5] * v[2],
          A[4] * v[0] + A[5] * v[1] + A[2] * v[2]};
}

/// |A|^2, the sum over all nine components.
template <class Pack>
inline Pack square(const PackSymmetric<Pack>& A) {
  return A[0] * A[0] + A[1] * A[1] + A[2] * A[2] + 2 * (A[3] * A[3] + A[4] * A[4] + A[5] * A[5]);
}

template <class Pack>
inline void rotation_matrix(const std::array<Pack, 4>& q, PackMatrix<Pack>& R) {
  const Pack x2 = q[1] + q[1], y2 = q[2] + q[2], z2 = q[3] + q[3];
  const Pack xx = q[1] * x2, yy = q[2] * y2, zz = q[3] * z2;
  const Pack xy = q[1] * y2, xz = q[1] * z2, yz = q[2] * z2;
  const Pack wx = q[0] * x2, wy = q[0] * y2, wz = q[0] * z2;
  R = {1 - (yy + zz), xy - wz, xz + wy, xy + wz,      1 - (xx + zz),
       yz - wx,       xz - wy, yz + wx, 1 - (xx + yy)};
}

/// E = sym(R^T F) - I, g = vee(R^T F - F^T R).
template <class Pack>
inline void stretch(const PackMatrix<Pack>& R, const PackMatrix<Pack>& F, PackSymmetric<Pack>& E,
                    PackVector<Pack>& g) {
  const auto dot = [&](int i, int j) -> Pack {
    return R[i] * F[j] + R[3 + i] * F[3 + j] + R[6 + i] * F[6 + j];
  };
  const Pack b01 = dot(0, 1), b10 = dot(1, 0), b02 = dot(0, 2), b20 = dot(2, 0);
  const Pack b12 = dot(1, 2), b21 = dot(2, 1);
  const Pack half = math::splat<Pack>(0.5);
  E = {dot(0, 0) - 1,      dot(1, 1) - 1,      dot(2, 2) - 1,
       half * (b01 + b10), half * (b02 + b20), half * (b12 + b21)};
  g = {b21 - b12, b02 - b20, b10 - b01};
}

/// Rotates q by w = v / d in the frame of the point, to third order: by the unit quaternion of (1 -
/// |w/4|^2, w/2), which needs one division for both w and the norm, and no square root. The
/// rounding error of q's norm is corrected to first order. Returns |w|^2, or less if it is not
/// small.
template <class Pack>
inline Pack turn(const PackVector<Pack>& v, Pack d, std::array<Pack, 4>& q) {
  const Pack norm2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const Pack d4 = 4 * d, d8 = 8 * d, dd = d4 * d4;
  const Pack vv = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  const Pack inverse = 1 / (dd + vv);
  const Pack scale = (math::splat<Pack>(1.5) - math::splat<Pack>(0.5) * norm2) * inverse;
  const Pack w = (dd - vv) * scale, turning = d8 * scale;
  const Pack a = turning * v[0], b = turning * v[1], c = turning * v[2];
  q = {q[0] * w - q[1] * a - q[2] * b - q[3] * c, q[1] * w + q[0] * a + q[2] * c - q[3] * b,
       q[2] * w + q[0] * b + q[3] * a - q[1] * c, q[3] * w + q[0] * c + q[1] * b - q[2] * a};
  return 16 * vv * inverse;
}

/// Computes one lane by a singular value decomposition, which also handles inverted points.
template <class Pack>
inline void rescue(const PackMatrix<Pack>& F, int lane, std::array<Pack, 4>& q) {
  Eigen::Matrix3d f;
  for (int k = 0; k < 9; ++k) f(k / 3, k % 3) = static_cast<double>(F[k][lane]);
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  if (f.allFinite()) rotation = Eigen::Quaterniond(math::polar_rotation(f)).normalized();
  using Real = typename math::PackTraits<Pack>::Real;
  q[0][lane] = static_cast<Real>(rotation.w());
  q[1][lane] = static_cast<Real>(rotation.x());
  q[2][lane] = static_cast<Real>(rotation.y());
  q[3][lane] = static_cast<Real>(rotation.z());
}

}  // namespace detail

/// Rotations R of the polar decompositions of F at `kCount` points by Newton's method on the unit
/// quaternion (Kugelstadt, Koschier and Bender 2018), starting from the previous rotations; by a
/// singular value decomposition where it finds no maximum of tr(R^T F). Sets E = R^T F - I in
/// `state` and R in `R`. Each stage processes all points in succession, because a processor
/// overlaps their long dependency chains only if they are close together.
template <class Pack, std::size_t kCount>
inline void update_rotations(const std::array<PackMatrix<Pack>, kCount>& F,
                             std::array<PointState<Pack>, kCount>& state,
                             std::array<PackMatrix<Pack>, kCount>& R) noexcept {
  constexpr int kMaxNewton = 8;
  // After a rotation by w the remaining error is of order w^3, because tr(R^T F) has no third-order
  // term at its maximum; strains are affected by that times |E| only.
  const Pack rounding = math::splat<Pack>(sizeof(F[0][0][0]) == 4 ? 1e-7 : 1e-13);
  std::array<PackVector<Pack>, kCount> v;  // rotations to apply, times d
  std::array<Pack, kCount> d, strain2;
  std::array<decltype(Pack{} < Pack{}), kCount> near, positive;
  for (std::size_t p = 0; p < kCount; ++p) {
    detail::rotation_matrix(state[p].rotation, R[p]);
  }
  for (int i = 0; i <= kMaxNewton; ++i) {
    for (std::size_t p = 0; p < kCount; ++p) {
      PackVector<Pack> g;
      detail::stretch(R[p], F[p], state[p].strain, g);
      const detail::Inverse<Pack> h = detail::invert_turn_stiffness(state[p].strain);
      v[p] = detail::times(h.adjugate, g);
      d[p] = h.determinant;
      positive[p] = h.positive;
      strain2[p] = detail::square(state[p].strain);
    }
    for (std::size_t p = 0; p < kCount; ++p) {
      const Pack turn2 = detail::turn(v[p], d[p], state[p].rotation);
      near[p] = positive[p] & (turn2 * turn2 * turn2 * strain2[p] < rounding * rounding);
      detail::rotation_matrix(state[p].rotation, R[p]);
    }
    auto settled = near[0];
    for (std::size_t p = 1; p < kCount; ++p) settled &= near[p];
    if (math::all(settled)) break;
    for (std::size_t p = 0; p < kCount; ++p) {
      if (i < kMaxNewton && math::all(positive[p])) continue;
      for (int lane = 0; lane < math::kLanes<Pack>; ++lane) {
        if (!near[p][lane]) detail::rescue(F[p], lane, state[p].rotation);
      }
      detail::rotation_matrix(state[p].rotation, R[p]);
    }
  }
  for (std::size_t p = 0; p < kCount; ++p) {
    PackVector<Pack> g;
    detail::stretch(R[p], F[p], state[p].strain, g);
  }
}

/// Stress of the linear law, mu |E|^2 + lambda/2 tr^2 E. What add_stress() asks of a law: `Axes`, a
/// point's data that prepare() finds for several points in succession and that is kept for the next
/// evaluation, and evaluate().
struct LinearStress {
  template <class Pack>
  struct Axes {};

  template <class Pack, std::size_t kCount>
  void prepare(const std::array<PointState<Pack>, kCount>&,
               std::array<Axes<Pack>, kCount>&) const noexcept {}

  /// Energy density; sets T = R^T P.
  template <class Pack>
  [[gnu::always_inline]] Pack evaluate(Pack mu, Pack lambda, const PackSymmetric<Pack>& E,
                                       const Axes<Pack>&, PackMatrix<Pack>& T) const noexcept {
    const Pack mu2 = mu + mu;
    const Pack half = math::splat<Pack>(0.5);
    const Pack trace = E[0] + E[1] + E[2];
    const Pack energy = mu * detail::square(E) + half * lambda * trace * trace;
    const Pack pressure = lambda * trace;
    T[0] = mu2 * E[0] + pressure;
    T[4] = mu2 * E[1] + pressure;
    T[8] = mu2 * E[2] + pressure;
    T[1] = T[3] = mu2 * E[3];
    T[2] = T[6] = mu2 * E[4];
    T[5] = T[7] = mu2 * E[5];
    return energy;
  }
};

/// Energy density and first Piola-Kirchhoff stress P of
///   Psi(E) + viscous (mu |E - E0|^2 + lambda/2 tr^2(E - E0)),
/// Psi being the energy of `law` and E0 the strain at the beginning of the step: Rayleigh damping
/// in the rotated frame, which does not act on rigid motions, and whose stress is the exact
/// derivative of its potential. Always inlined, so that P stays in registers on its way to the
/// nodes.
template <class Law, class Pack>
[[gnu::always_inline]] inline Pack add_stress(const Law& law, Pack mu, Pack lambda,
                                              double viscosity, const PointState<Pack>& state,
                                              const typename Law::template Axes<Pack>& axes,
                                              const PackMatrix<Pack>& R,
                                              PackMatrix<Pack>& P) noexcept {
  const PackSymmetric<Pack>& E = state.strain;
  PackMatrix<Pack> T;  // R^T P
  Pack energy = law.evaluate(mu, lambda, E, axes, T);

  if (viscosity > 0) {
    const Pack mu2 = mu + mu;
    const Pack half = math::splat<Pack>(0.5);
    const Pack viscous = math::splat<Pack>(viscosity);
    const PackSymmetric<Pack>& Z = state.previous_strain;
    const PackSymmetric<Pack> D{E[0] - Z[0], E[1] - Z[1], E[2] - Z[2],
                                E[3] - Z[3], E[4] - Z[4], E[5] - Z[5]};
    const Pack rate = D[0] + D[1] + D[2];
    energy += viscous * (mu * detail::square(D) + half * lambda * rate * rate);
    // E0 does not rotate with the point, therefore the rotation caused by dF does work on the
    // commutator of E0 and E: c = vee(Z E - E Z).
    const PackVector<Pack> c{
        Z[4] * E[3] + Z[5] * E[1] + Z[2] * E[5] - (Z[3] * E[4] + Z[1] * E[5] + Z[5] * E[2]),
        Z[0] * E[4] + Z[3] * E[5] + Z[4] * E[2] - (Z[4] * E[0] + Z[5] * E[3] + Z[2] * E[4]),
        Z[3] * E[0] + Z[1] * E[3] + Z[5] * E[4] - (Z[0] * E[3] + Z[3] * E[1] + Z[4] * E[5])};
    const detail::Inverse<Pack> h = detail::invert_turn_stiffness(E);
    const Pack scale = h.positive ? viscous * mu2 / h.determinant : Pack{};
    PackVector<Pack> w = detail::times(h.adjugate, c);
    for (Pack& component : w) component *= scale;
    const Pack viscous_pressure = viscous * lambda * rate;
    const Pack m = viscous * mu2;
    T[0] += m * D[0] + viscous_pressure;
    T[4] += m * D[1] + viscous_pressure;
    T[8] += m * D[2] + viscous_pressure;
    T[1] += m * D[3] - w[2];
    T[3] += m * D[3] + w[2];
    T[2] += m * D[4] + w[1];
    T[6] += m * D[4] - w[1];
    T[5] += m * D[5] - w[0];
    T[7] += m * D[5] + w[0];
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      P[3 * i + j] = R[3 * i] * T[j] + R[3 * i + 1] * T[3 + j] + R[3 * i + 2] * T[6 + j];
    }
  }
  return energy;
}

}  // namespace palpate::elasticity
