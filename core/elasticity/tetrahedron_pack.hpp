#pragma once

#include <array>
#include <vector>

#include "core/elasticity/element_forces.hpp"
#include "core/elasticity/element_set.hpp"
#include "core/elasticity/node_transfer.hpp"

namespace palpate::elasticity {

/// R D R^T.
template <class Pack>
inline PackMatrix<Pack> turned(const PackMatrix<Pack>& R, const PackSymmetric<Pack>& D) {
  const PackMatrix<Pack> full{D[0], D[3], D[4], D[3], D[1], D[5], D[4], D[5], D[2]};
  PackMatrix<Pack> T, out;
  for (int i = 0; i < 9; i += 3) {
    for (int j = 0; j < 3; ++j) {
      T[i + j] = R[i] * full[j] + R[i + 1] * full[3 + j] + R[i + 2] * full[6 + j];
    }
  }
  for (int i = 0; i < 9; i += 3) {
    for (int j = 0; j < 3; ++j) {
      out[i + j] = T[i] * R[3 * j] + T[i + 1] * R[3 * j + 1] + T[i + 2] * R[3 * j + 2];
    }
  }
  return out;
}

/// Four straight-sided tetrahedra, one per lane, with the gradients of all shape functions at their
/// quadrature points. Intended for work that uses these gradients many times, unlike ElementBlock,
/// which minimises memory traffic for the loop.
template <int kNodes>
class alignas(64) TetrahedronPack {
 public:
  using Pack = math::Pack4d;
  static constexpr int kPoints = Tetrahedron<kNodes>::kPoints;
  static constexpr int kWidth = math::kLanes<Pack>;
  using Gradients = std::array<PackVector<Pack>, kNodes>;
  template <class T>
  using PerPoint = std::array<T, kPoints>;

  /// Elements `first` to `first` + 3. Lanes beyond the last element repeat it with weight zero.
  TetrahedronPack(const ElementSet& elements, int first) : first_(first) {
    const mesh::ElementMesh& mesh = elements.mesh();
    for (int lane = 0; lane < kWidth; ++lane) {
      const int e = std::min(first + lane, elements.element_count() - 1);
      const Eigen::Matrix<double, 3, 4> corners = elements.rest_corners(e);
      const auto gradients = Tetrahedron<kNodes>::gradients(corners);
      for (int a = 0; a < kNodes; ++a) {
        offsets_[a][lane] = 4 * mesh.elements(a, e);
        for (int p = 0; p < kPoints; ++p) {
          for (int c = 0; c < 3; ++c) gradients_[p][a][c][lane] = gradients[p](c, a);
        }
      }
      weight_[lane] = first + lane == e ? tetrahedron_volume(corners) / kPoints : 0;
      mu_[lane] = weight_[lane] * elements.materials().lame[e].mu;
      lambda_[lane] = weight_[lane] * elements.materials().lame[e].lambda;
      count_ += first + lane == e;
    }
  }

  int first() const { return first_; }
  int count() const { return count_; }  // number of elements, which occupy the first lanes
  const PerPoint<Gradients>& gradients() const { return gradients_; }
  Pack weight() const { return weight_; }  // volume of a point, m^3
  /// Lame parameters times the volume of a point, J.
  Pack mu() const { return mu_; }
  Pack lambda() const { return lambda_; }

  /// F at each point, from node positions in mesh order.
  PerPoint<PackMatrix<Pack>> deformation(const NodalField& x) const {
    PerPoint<PackMatrix<Pack>> F{};
    for (int a = 1; a < kNodes; ++a) {  // relative to the first node, because gradients sum to zero
      PackVector<Pack> d;
      gather_difference(x.data(), offsets_[a].data(), offsets_[0].data(), d);
      for (int p = 0; p < kPoints; ++p) {
        const PackVector<Pack>& g = gradients_[p][a];
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) F[p][3 * i + j] += d[i] * g[j];
        }
      }
    }
    return F;
  }

 private:
  int first_, count_ = 0;
  std::array<std::array<int, kWidth>, kNodes> offsets_{};  // offsets in nodal fields
  PerPoint<Gradients> gradients_{};                        // 1/m
  Pack weight_{}, mu_{}, lambda_{};
};

/// All elements of a body in packs of four, and the state of their points.
template <int kNodes>
struct TetrahedronPacks {
  using Block = TetrahedronPack<kNodes>;
  using State = typename Block::template PerPoint<PointState<math::Pack4d>>;

  explicit TetrahedronPacks(const ElementSet& elements) {
    for (int e = 0; e < elements.element_count(); e += Block::kWidth) {
      blocks.emplace_back(elements, e);
    }
    states.resize(blocks.size());
  }

  std::vector<Block> blocks;
  std::vector<State> states;
};

}  // namespace palpate::elasticity
