#include "tests/bench/core/elasticity/curved_pass.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace palpate::bench {
namespace {

using elasticity::kFar;
using elasticity::kNear;

/// Node between corners i and j; the corner itself if they are equal.
constexpr int kBetween[4][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}};

/// Derivative of the shape function of kBetween[i][j] by the barycentric coordinate i at point p.
constexpr double slope(int p, int i, int j) {
  return 4 * (j == p ? kNear : kFar) - (i == j ? 1 : 0);
}

}  // namespace

CurvedPass::CurvedPass(const elasticity::Body& body) {
  const mesh::ElementMesh& mesh = body.mesh;
  const int count = mesh.element_count();
  blocks_.resize((count + 3) / 4);
  state_.resize(blocks_.size());
  for (int k = 0; k < 4 * static_cast<int>(blocks_.size()); ++k) {
    Block& block = blocks_[k / 4];
    const int lane = k % 4, e = std::min(k, count - 1);
    for (int a = 0; a < 10; ++a) block.offsets[a][lane] = 4 * mesh.elements(a, e);
    for (int p = 0; p < 4; ++p) {
      Eigen::Matrix<double, 3, 4> by_coordinate = Eigen::Matrix<double, 3, 4>::Zero();
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
          by_coordinate.col(i) += slope(p, i, j) * mesh.nodes.col(mesh.elements(kBetween[i][j], e));
        }
      }
      const Eigen::Matrix3d jacobian =
          by_coordinate.rightCols<3>().colwise() - by_coordinate.col(0);
      const Eigen::Matrix3d inverse = jacobian.inverse();
      for (int i = 0; i < 3; ++i) {
        for (int c = 0; c < 3; ++c) block.gradients[p][i][c][lane] = inverse(i, c);
      }
      // The last block is padded with elements of zero weight.
      const double weight = k < count ? jacobian.determinant() / 24 : 0;
      const elasticity::Lame lame = elasticity::lame(body.material_of(e));
      block.mu[p][lane] = weight * lame.mu;
      block.lambda[p][lane] = weight * lame.lambda;
    }
  }
}

double CurvedPass::add(const elasticity::NodalField& x, elasticity::NodalField& forces) noexcept {
  Pack energy{};
  for (std::size_t b = 0; b < blocks_.size(); ++b) energy += add_block(x.data(), b, forces.data());
  return math::sum(energy);
}

CurvedPass::Pack CurvedPass::add_block(const double* x, std::size_t b, double* forces) noexcept {
  using elasticity::PackMatrix;
  const Block& block = blocks_[b];
  std::array<Vector, 10> d, f{};
  d[0] = {};
  for (int a = 1; a < 10; ++a) {
    elasticity::gather_difference(x, block.offsets[a].data(), block.offsets[0].data(), d[a]);
  }
  std::array<PackMatrix<Pack>, 4> F{}, R;
  for (int p = 0; p < 4; ++p) {
    std::array<Vector, 4> c{};
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        for (int k = 0; k < 3; ++k) c[i][k] += slope(p, i, j) * d[kBetween[i][j]][k];
      }
    }
    for (int i = 1; i < 4; ++i) {
      for (int k = 0; k < 3; ++k) {
        const Pack change = c[i][k] - c[0][k];
        for (int l = 0; l < 3; ++l) F[p][3 * k + l] += change * block.gradients[p][i - 1][l];
      }
    }
  }
  elasticity::update_rotations(F, state_[b], R);
  Pack energy{};
  for (int p = 0; p < 4; ++p) {
    PackMatrix<Pack> P;
    energy += elasticity::add_stress(elasticity::LinearStress(), block.mu[p], block.lambda[p], 0,
                                     state_[b][p], {}, R[p], P);
    std::array<Vector, 4> traction{};  // P grad b_i
    for (int i = 1; i < 4; ++i) {
      const Vector& g = block.gradients[p][i - 1];
      for (int k = 0; k < 3; ++k) {
        traction[i][k] = P[3 * k] * g[0] + P[3 * k + 1] * g[1] + P[3 * k + 2] * g[2];
        traction[0][k] -= traction[i][k];
      }
    }
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        for (int k = 0; k < 3; ++k) f[kBetween[i][j]][k] += slope(p, i, j) * traction[i][k];
      }
    }
  }
  for (int a = 0; a < 10; ++a) elasticity::scatter_add(f[a], block.offsets[a].data(), forces);
  return energy;
}

}  // namespace palpate::bench
