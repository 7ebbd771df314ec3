#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/elasticity/element.hpp"
#include "core/elasticity/node_transfer.hpp"
#include "core/elasticity/point_kernel.hpp"

namespace palpate::elasticity {

/// Straight-sided tetrahedra with 4 or 10 nodes, one per lane of a pack. Only the gradients of the
/// barycentric coordinates are stored: those of quadratic shape functions are linear in them,
///   grad N_i = (4 b_i - 1) g_i,  grad N_ij = 4 (b_i g_j + b_j g_i),
/// so that F = sum_i c_i x g_i at each point and a pack reads 22 numbers per element.
template <class Pack, int kNodes>
struct ElementPack {
  using Real = typename math::PackTraits<Pack>::Real;
  using Vector = PackVector<Pack>;

  /// x_a - x_0.
  Vector difference(const double* x, int a) const {
    Vector d;
    gather_difference(x, offsets[a].data(), offsets[0].data(), d);
    return d;
  }
  /// Adds f to node a.
  void scatter(const Vector& f, int a, Real* forces) const {
    scatter_add(f, offsets[a].data(), forces);
  }

  /// F = sum_i c_i x g_i.
  PackMatrix<Pack> gradient_of(const std::array<Vector, 3>& c) const {
    PackMatrix<Pack> F;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        F[3 * i + j] =
            c[0][i] * gradients[0][j] + c[1][i] * gradients[1][j] + c[2][i] * gradients[2][j];
      }
    }
    return F;
  }

  /// P g_i.
  Vector traction(const PackMatrix<Pack>& P, int i) const {
    const Vector& g = gradients[i];
    return {P[0] * g[0] + P[1] * g[1] + P[2] * g[2], P[3] * g[0] + P[4] * g[1] + P[5] * g[2],
            P[6] * g[0] + P[7] * g[1] + P[8] * g[2]};
  }

  std::array<std::array<int, math::kLanes<Pack>>, kNodes> offsets{};  // offsets in nodal fields
  std::array<Vector, 3> gradients{};  // gradients of the barycentric coordinates 1, 2, 3; 1/m
  Pack mu{}, lambda{};                // times the volume of a point, J; 0 without an element
};

/// Elements whose points are processed together in each stage of a pass.
template <class Pack, int kNodes>
class alignas(64) ElementBlock {
 public:
  static constexpr int kPoints = Tetrahedron<kNodes>::kPoints;  // points of an element
  static constexpr int kPacks = kNodes == 4 ? 2 : 1;
  static constexpr int kElements = kPacks * math::kLanes<Pack>;
  using State = std::array<PointState<Pack>, kPacks * kPoints>;
  using Real = typename math::PackTraits<Pack>::Real;
  template <class Law>
  using Axes = std::array<typename Law::template Axes<Pack>, kPacks * kPoints>;

  void set(int place, const mesh::ElementMesh& mesh, int element,
           const std::vector<Lame>& materials, const std::vector<int>& numbering, bool weighted) {
    Eigen::Matrix<double, 3, 4> corners;
    for (int a = 0; a < 4; ++a) corners.col(a) = mesh.nodes.col(mesh.elements(a, element));
    const double volume = tetrahedron_volume(corners);
    if (!(volume > 0)) {
      throw std::invalid_argument("element " + std::to_string(element) + " has no positive volume");
    }
    ElementPack<Pack, kNodes>& pack = packs_[place / kLanes];
    const int lane = place % kLanes;
    for (int a = 0; a < kNodes; ++a) {
      pack.offsets[a][lane] = 4 * numbering[mesh.elements(a, element)];
    }
    const Eigen::Matrix<double, 3, 4> g = barycentric_gradients(corners);
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 3; ++c) pack.gradients[i][c][lane] = static_cast<Real>(g(c, i + 1));
    }
    const double weight = weighted ? volume / kPoints : 0;
    pack.mu[lane] = static_cast<Real>(weight * materials[element].mu);
    pack.lambda[lane] = static_cast<Real>(weight * materials[element].lambda);
  }

  /// Counts lanes whose element is inverted (at a quadrature point or, if its sides are curved, at
  /// a corner), and those strained at a point by more than `limit` (norm of E).
  void add_doubts(const double* x, const State& state, double limit,
                  ElementDoubts& doubts) const noexcept {
    const Pack limit2 = math::splat<Pack>(limit * limit);
    for (int k = 0; k < kPacks; ++k) {
      const auto& pack = packs_[k];
      auto bad = Pack{} != Pack{}, strained = bad;
      for (int p = 0; p < kPoints; ++p) {
        const PackSymmetric<Pack>& E = state[kPoints * k + p].strain;
        bad |= determinant({1 + E[0], E[3], E[4], E[3], 1 + E[1], E[5], E[4], E[5], 1 + E[2]}) <= 0;
        strained |= detail::square(E) > limit2;
      }
      for (int p = 0; p < 4 && kNodes == 10; ++p) {
        // only the p-th barycentric coordinate is non-zero: c_p = 3 x_p, c_i = 4 x_ip - x_i
        std::array<Vector, 4> c;
        for (int i = 0; i < 4; ++i) {
          const Vector middle = pack.difference(x, kMidside[i][p]), own = pack.difference(x, i);
          for (int m = 0; m < 3; ++m) c[i][m] = i == p ? 3 * own[m] : 4 * middle[m] - own[m];
        }
        for (int i = 1; i < 4; ++i) {
          for (int m = 0; m < 3; ++m) c[i][m] -= c[0][m];
        }
        bad |= determinant(pack.gradient_of({c[1], c[2], c[3]})) <= 0;
      }
      for (int lane = 0; lane < kLanes; ++lane) {
        doubts.inverted += bad[lane] && pack.mu[lane] != 0;
        doubts.strained += strained[lane] && pack.mu[lane] != 0;
      }
    }
  }

  /// Adds the rotation of each element, the mean over its points, to its corners in `sums`; signs
  /// of quaternions, four numbers per node, as in `near`.
  void add_rotations(const State& state, const float* near, float* sums) const noexcept {
    using Quaternion = std::array<Pack, 4>;
    const auto aligned = [](const Quaternion& q, const Quaternion& to) -> Quaternion {
      const Pack dot = q[0] * to[0] + q[1] * to[1] + q[2] * to[2] + q[3] * to[3];
      const Pack sign = dot < 0 ? math::splat<Pack>(-1) : math::splat<Pack>(1);
      return {sign * q[0], sign * q[1], sign * q[2], sign * q[3]};
    };
    for (int k = 0; k < kPacks; ++k) {
      const auto& pack = packs_[k];
      Quaternion sum{};
      for (int p = 0; p < kPoints; ++p) {
        const Quaternion q = aligned(state[kPoints * k + p].rotation, sum);
        for (int c = 0; c < 4; ++c) sum[c] += pack.mu != 0 ? q[c] : Pack{};
      }
      for (int a = 0; a < 4; ++a) {
        Quaternion of_node;
        gather(near, pack.offsets[a].data(), of_node);
        scatter_add(aligned(sum, of_node), pack.offsets[a].data(), sums);
      }
    }
  }

  /// Energy, J; adds the nodal forces to a field of four numbers per node. `law`: as LinearStress,
  /// `axes`: what it keeps between evaluations.
  template <class Law>
  Pack add(const Law& law, const double* x, double viscosity, State& state, Axes<Law>& axes,
           Real* forces) const noexcept {
    if constexpr (kNodes == 4) {
      return add_linear(law, x, viscosity, state, axes, forces);
    } else {
      return add_quadratic(law, x, viscosity, state, axes, forces);
    }
  }

 private:
  using Vector = PackVector<Pack>;

  static constexpr int kLanes = math::kLanes<Pack>;

  static Pack determinant(const PackMatrix<Pack>& m) {
    return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
           m[2] * (m[3] * m[7] - m[4] * m[6]);
  }

  template <class Law>
  Pack add_linear(const Law& law, const double* x, double viscosity, State& state, Axes<Law>& axes,
                  Real* forces) const noexcept {
    std::array<PackMatrix<Pack>, kPacks> F, R;
    for (int k = 0; k < kPacks; ++k) {
      const auto& pack = packs_[k];
      F[k] =
          pack.gradient_of({pack.difference(x, 1), pack.difference(x, 2), pack.difference(x, 3)});
    }
    update_rotations(F, state, R);
    law.prepare(state, axes);
    Pack energy{};
    for (int k = 0; k < kPacks; ++k) {
      const auto& pack = packs_[k];
      PackMatrix<Pack> P;
      energy += add_stress(law, pack.mu, pack.lambda, viscosity, state[k], axes[k], R[k], P);
      Vector rest{};
      for (int i = 0; i < 3; ++i) {
        const Vector t = pack.traction(P, i);
        for (int c = 0; c < 3; ++c) rest[c] -= t[c];
        pack.scatter(t, i + 1, forces);
      }
      pack.scatter(rest, 0, forces);
    }
    return energy;
  }

  template <class Law>
  Pack add_quadratic(const Law& law, const double* x, double viscosity, State& state,
                     Axes<Law>& axes, Real* forces) const noexcept {
    // Barycentric coordinates of point p are kFar, and kNear for the p-th.
    const Pack low = math::splat<Pack>(4 * kFar - 1), far4 = math::splat<Pack>(4 * kFar);
    const Pack rise = math::splat<Pack>(4 * (kNear - kFar));
    const auto& pack = packs_[0];
    std::array<Vector, 10> d;
    d[0] = Vector{};
    for (int a = 1; a < 10; ++a) d[a] = pack.difference(x, a);
    std::array<Vector, 4> base;  // c_i without the contribution of the near corner
    for (int i = 0; i < 4; ++i) {
      const Vector &p = d[kMidside[i][(i + 1) % 4]], &q = d[kMidside[i][(i + 2) % 4]],
                   &r = d[kMidside[i][(i + 3) % 4]];
      for (int c = 0; c < 3; ++c) base[i][c] = low * d[i][c] + far4 * (p[c] + q[c] + r[c]);
    }
    std::array<PackMatrix<Pack>, 4> F, R;
#pragma GCC unroll 4  // makes the nodes of an edge compile-time constants
    for (int p = 0; p < 4; ++p) {
      const Vector& d0 = d[kMidside[0][p]];  // for p = 0 the difference of corner 0 itself
      std::array<Vector, 3> c;
      for (int i = 1; i < 4; ++i) {
        const Vector& di = d[kMidside[i][p]];
        for (int k = 0; k < 3; ++k) {
          c[i - 1][k] = (base[i][k] - base[0][k]) + rise * (di[k] - d0[k]);
        }
      }
      F[p] = pack.gradient_of(c);
    }
    update_rotations(F, state, R);
    law.prepare(state, axes);
    Pack energy{};
    std::array<Vector, 4> sum{};       // sum over the points of the traction of each corner
    std::array<Vector, 10> special{};  // contribution of the near corner
#pragma GCC unroll 4                   // unrolled so that the nodes of an edge are compile-time
                                       // constants
    for (int p = 0; p < 4; ++p) {
      PackMatrix<Pack> P;
      energy += add_stress(law, pack.mu, pack.lambda, viscosity, state[p], axes[p], R[p], P);
      Vector rest{};
      for (int i = 1; i < 4; ++i) {
        const Vector t = pack.traction(P, i - 1);
        Vector& to = special[kMidside[i][p]];
        for (int k = 0; k < 3; ++k) {
          rest[k] -= t[k];
          sum[i][k] += t[k];
          to[k] += t[k];
        }
      }
      Vector& to = special[kMidside[0][p]];
      for (int k = 0; k < 3; ++k) {
        sum[0][k] += rest[k];
        to[k] += rest[k];
      }
    }
    for (int i = 0; i < 4; ++i) {
      Vector f;
      for (int k = 0; k < 3; ++k) f[k] = low * sum[i][k] + rise * special[i][k];
      pack.scatter(f, i, forces);
    }
    for (int m = 4; m < 10; ++m) {
      const int* edge = mesh::kTetrahedronEdges[m - 4];
      Vector f;
      for (int k = 0; k < 3; ++k) {
        f[k] = far4 * (sum[edge[0]][k] + sum[edge[1]][k]) + rise * special[m][k];
      }
      pack.scatter(f, m, forces);
    }
    return energy;
  }

  // Node between corners i and j; the corner itself if they are equal.
  static constexpr int kMidside[4][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}};

  std::array<ElementPack<Pack, kNodes>, kPacks> packs_;
};

}  // namespace palpate::elasticity
