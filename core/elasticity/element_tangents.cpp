#include "core/elasticity/element_tangents.hpp"

#include <vector>

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
      : packs_(elements), x_(NodalField::Zero(4, elements.mesh().node_count())) {
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
      add(packs_.blocks[b], packs_.states[b], kind, targets, tangent, warped);
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
