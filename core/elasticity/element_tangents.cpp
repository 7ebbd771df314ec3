#include "core/elasticity/element_tangents.hpp"

#include <Eigen/Eigenvalues>
#include <optional>
#include <vector>

#include "core/elasticity/principal_kernel.hpp"
#include "core/elasticity/tetrahedron_pack.hpp"

namespace palpate::elasticity {
namespace {

using math::Pack4d;
using Matrix = PackMatrix<Pack4d>;
using Vector = PackVector<Pack4d>;
using Symmetric = PackSymmetric<Pack4d>;

/// Resistance of a point against rotation of its nodes beyond the warped stiffness: its twist term
/// (PointTangent) minus mu, in its own axes. Lanes without a stable rotation use the scalar code,
/// as do all lanes if eigenvalues are clamped.
Symmetric excess_twist(const Symmetric& E, Pack4d mu, Pack4d lambda, Tangent kind) {
  const detail::Inverse<Pack4d> h = detail::invert_turn_stiffness(E);
  const Pack4d scale = (2 * mu - lambda * (E[0] + E[1] + E[2])) / h.determinant;
  Symmetric D;
  for (int k = 0; k < 6; ++k) D[k] = scale * h.adjugate[k];
  const auto regular = h.positive & (h.determinant > kSmallestTurnStiffness);
  if (kind != Tangent::kExact || !math::all(regular)) {
    for (int lane = 0; lane < math::kLanes<Pack4d>; ++lane) {
      if (kind == Tangent::kExact && regular[lane]) continue;
      Eigen::Matrix3d S;
      S << 1 + E[0][lane], E[3][lane], E[4][lane], E[3][lane], 1 + E[1][lane], E[5][lane],
          E[4][lane], E[5][lane], 1 + E[2][lane];
      const Eigen::Matrix3d twist = point_twist(S, {mu[lane], lambda[lane]}, kind);
      for (int k = 0; k < 3; ++k) D[k][lane] = twist(k, k);
      D[3][lane] = twist(0, 1);
      D[4][lane] = twist(0, 2);
      D[5][lane] = twist(1, 2);
    }
  }
  for (int k = 0; k < 3; ++k) D[k] -= mu;
  return D;
}

/// [h]x D.
Matrix cross(const Vector& h, const Matrix& D) {
  Matrix out;
  for (int j = 0; j < 3; ++j) {
    out[j] = h[1] * D[6 + j] - h[2] * D[3 + j];
    out[3 + j] = h[2] * D[j] - h[0] * D[6 + j];
    out[6 + j] = h[0] * D[3 + j] - h[1] * D[j];
  }
  return out;
}

Matrix transposed(const Matrix& m) {
  return {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]};
}

Matrix product(const Matrix& A, const Matrix& B) {
  Matrix out;
  for (int i = 0; i < 9; i += 3) {
    for (int j = 0; j < 3; ++j)
      out[i + j] = A[i] * B[j] + A[i + 1] * B[3 + j] + A[i + 2] * B[6 + j];
  }
  return out;
}

/// Sets negative eigenvalues to zero, lane by lane.
void make_semidefinite(PrincipalTangent<Pack4d>& point) {
  for (int k = 0; k < 3; ++k) {
    point.axes[k] = point.axes[k] > 0 ? point.axes[k] : Pack4d{};
    point.turn[k] = point.turn[k] > 0 ? point.turn[k] : Pack4d{};
  }
  Symmetric& H = point.hessian;
  for (int lane = 0; lane < math::kLanes<Pack4d>; ++lane) {
    Eigen::Matrix3d h;
    h << H[0][lane], H[3][lane], H[4][lane], H[3][lane], H[1][lane], H[5][lane], H[4][lane],
        H[5][lane], H[2][lane];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(h);
    const Eigen::Vector3d values = eigen.eigenvalues().cwiseMax(0);
    h = eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
    for (int k = 0; k < 3; ++k) H[k][lane] = h(k, k);
    H[3][lane] = h(0, 1);
    H[4][lane] = h(0, 2);
    H[5][lane] = h(1, 2);
  }
}

/// The nine numbers of each lane, lane by lane.
struct Lanes {
  explicit Lanes(const Matrix& m) {
    for (int k = 0; k < 9; ++k) {
      for (int lane = 0; lane < 4; ++lane) numbers[lane][k] = m[k][lane];
    }
  }
  double numbers[4][9];
};

template <int kNodes>
class PackTangents final : public ElementTangents {
 public:
  PackTangents(const ElementSet& elements, const factor::BlockPattern& pattern)
      : law_(elements.materials().law),
        packs_(elements),
        x_(NodalField::Zero(4, elements.mesh().node_count())) {
    for (const Block& block : packs_.blocks) {
      for (int a = 0; a < kNodes; ++a) {
        for (int b = a; b < kNodes; ++b) {
          for (int lane = 0; lane < Block::kWidth; ++lane) {
            Target target;
            if (lane < block.count()) {
              target.upper = pattern.slot(block.first() + lane, a, b);
              if (a != b) target.lower = pattern.slot(block.first() + lane, b, a);
            }
            targets_.push_back(target);
          }
        }
      }
    }
  }

  void assemble(const Eigen::Matrix3Xd& x, Tangent kind, factor::BlockMatrix& tangent,
                factor::BlockMatrix* warped) noexcept override {
    x_.topRows<3>() = x;
    tangent.set_zero();
    if (warped) warped->set_zero();
    const Target* targets = targets_.data();
    for (std::size_t b = 0; b < packs_.blocks.size(); ++b, targets += kTargets) {
      if (law_ && kind != Tangent::kWarped) {
        add_hyperelastic(packs_.blocks[b], packs_.states[b], kind, targets, tangent);
        if (warped) {
          add(packs_.blocks[b], packs_.states[b], Tangent::kWarped, targets, *warped, nullptr);
        }
      } else {
        add(packs_.blocks[b], packs_.states[b], kind, targets, tangent, warped);
      }
    }
  }

 private:
  using Packs = TetrahedronPacks<kNodes>;
  using Block = typename Packs::Block;
  template <class T>
  using PerPoint = typename Block::template PerPoint<T>;
  static constexpr int kTargets = kNodes * (kNodes + 1) / 2 * Block::kWidth;

  /// Destination of block (a, b) of an element: stored as is, transposed to (b, a), or not stored.
  struct Target {
    int upper = -1, lower = -1;
  };

  void add(const Block& block, typename Packs::State& state, Tangent kind, const Target* target,
           factor::BlockMatrix& tangent, factor::BlockMatrix* warped) noexcept {
    const PerPoint<Matrix> F = block.deformation(x_);
    PerPoint<Matrix> R;
    update_rotations(F, state, R);
    const Pack4d mu = block.mu(), lambda = block.lambda();
    PerPoint<std::array<Vector, kNodes>> h;     // R grad N_a
    PerPoint<std::array<Matrix, kNodes>> left;  // [h_a]x times the excess twist
    for (int p = 0; p < Block::kPoints; ++p) {
      Matrix D{};
      if (kind != Tangent::kWarped) {
        D = turned(R[p], excess_twist(state[p].strain, mu, lambda, kind));
      }
      for (int a = 0; a < kNodes; ++a) {
        const Vector& g = block.gradients()[p][a];
        for (int i = 0; i < 3; ++i) {
          h[p][a][i] = R[p][3 * i] * g[0] + R[p][3 * i + 1] * g[1] + R[p][3 * i + 2] * g[2];
        }
        left[p][a] = cross(h[p][a], D);
      }
    }
    for (int a = 0; a < kNodes; ++a) {
      for (int b = a; b < kNodes; ++b, target += Block::kWidth) {
        Matrix products{}, K{};  // sums over points of h_a h_b^T and of left_a [h_b]x
        for (int i = 0; i < 9; i += 3) {
          for (int p = 0; p < Block::kPoints; ++p) {
            const Vector& hb = h[p][b];
            const Pack4d ha = h[p][a][i / 3];
            const Matrix& l = left[p][a];
            for (int j = 0; j < 3; ++j) products[i + j] += ha * hb[j];
            K[i] += l[i + 1] * hb[2] - l[i + 2] * hb[1];
            K[i + 1] += l[i + 2] * hb[0] - l[i] * hb[2];
            K[i + 2] += l[i] * hb[1] - l[i + 1] * hb[0];
          }
        }
        const Pack4d diagonal = mu * (products[0] + products[4] + products[8]);
        Matrix W;
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            W[3 * i + j] = lambda * products[3 * i + j] + mu * products[3 * j + i];
          }
          W[4 * i] += diagonal;
        }
        for (int k = 0; k < 9; ++k) K[k] += W[k];
        scatter(K, target, tangent);
        if (warped) scatter(W, target, *warped);
      }
    }
  }

  void add_hyperelastic(const Block& block, typename Packs::State& state, Tangent kind,
                        const Target* target, factor::BlockMatrix& tangent) noexcept {
    const PerPoint<Matrix> F = block.deformation(x_);
    PerPoint<Matrix> R;
    update_rotations(F, state, R);
    PerPoint<PrincipalAxes<Pack4d>> at;
    find_principal_axes(state, at);
    PerPoint<Matrix> U;                         // principal axes in space, R V
    PerPoint<std::array<Vector, kNodes>> g;     // V^T grad N_a
    PerPoint<std::array<Matrix, 2>> stiffness;  // of D_ij against itself, and against D_ji
    PerPoint<Symmetric> hessian;
    for (int p = 0; p < Block::kPoints; ++p) {
      const Matrix& V = at[p].axes;
      U[p] = product(R[p], V);
      for (int a = 0; a < kNodes; ++a) {
        const Vector& n = block.gradients()[p][a];
        for (int i = 0; i < 3; ++i) g[p][a][i] = V[i] * n[0] + V[3 + i] * n[1] + V[6 + i] * n[2];
      }
      PrincipalTangent<Pack4d> point(
          PrincipalResponse<Pack4d>(*law_, block.mu(), block.lambda(), at[p].strain));
      if (kind == Tangent::kSemidefinite) make_semidefinite(point);
      hessian[p] = point.hessian;
      stiffness[p] = {};
      for (int k = 0; k < 3; ++k) {
        const int ij = 3 * ((k + 1) % 3) + (k + 2) % 3, ji = 3 * ((k + 2) % 3) + (k + 1) % 3;
        stiffness[p][0][ij] = stiffness[p][0][ji] = point.same(k);
        stiffness[p][1][ij] = stiffness[p][1][ji] = point.crossed(k);
      }
    }
    for (int a = 0; a < kNodes; ++a) {
      for (int b = a; b < kNodes; ++b, target += Block::kWidth) {
        Matrix K{};
        for (int p = 0; p < Block::kPoints; ++p) {
          const Vector &ga = g[p][a], &gb = g[p][b];
          const Symmetric& H = hessian[p];
          Matrix k;  // in principal axes
          for (int i = 0; i < 3; ++i) {
            const int m = (i + 1) % 3, n = (i + 2) % 3;
            k[4 * i] = H[i] * ga[i] * gb[i] + stiffness[p][0][3 * i + m] * ga[m] * gb[m] +
                       stiffness[p][0][3 * i + n] * ga[n] * gb[n];
            k[3 * m + n] = H[5 - i] * ga[m] * gb[n] + stiffness[p][1][3 * m + n] * ga[n] * gb[m];
            k[3 * n + m] = H[5 - i] * ga[n] * gb[m] + stiffness[p][1][3 * m + n] * ga[m] * gb[n];
          }
          const Matrix turned_k = product(product(U[p], k), transposed(U[p]));
          for (int c = 0; c < 9; ++c) K[c] += turned_k[c];
        }
        scatter(K, target, tangent);
      }
    }
  }

  static void scatter(const Matrix& K, const Target* target, factor::BlockMatrix& to) noexcept {
    // blocks are column-major, packs hold rows
    const Lanes upper(transposed(K)), lower(K);
    for (int lane = 0; lane < Block::kWidth; ++lane) {
      const auto add = [&](int slot, const Lanes& from) {
        if (slot < 0) return;
        double* sum = to.block(slot).data();
        for (int k = 0; k < 9; ++k) sum[k] += from.numbers[lane][k];
      };
      add(target[lane].upper, upper);
      add(target[lane].lower, lower);
    }
  }

  std::optional<StretchLaw> law_;
  Packs packs_;
  std::vector<Target> targets_;  // lanes of each pair of nodes, block after block
  NodalField x_;
};

}  // namespace

std::unique_ptr<ElementTangents> make_element_tangents(const ElementSet& elements,
                                                       const factor::BlockPattern& pattern) {
  if (elements.mesh().order == mesh::ElementOrder::kLinear) {
    return std::make_unique<PackTangents<4>>(elements, pattern);
  }
  return std::make_unique<PackTangents<10>>(elements, pattern);
}

Eigen::VectorXd mass_blocks(const ElementSet& elements, const factor::BlockPattern& pattern) {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(static_cast<int>(pattern.row().size()));
  Eigen::MatrixXd m;
  for (int e = 0; e < elements.element_count(); ++e) {
    elements.mass(e, m);
    for (int a = 0; a < m.rows(); ++a) {
      for (int b = 0; b < m.cols(); ++b) {
        const int slot = pattern.slot(e, a, b);
        if (slot >= 0) mass(slot) += m(a, b);
      }
    }
  }
  return mass;
}

}  // namespace palpate::elasticity
