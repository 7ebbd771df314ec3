#pragma once

#include <array>
#include <vector>

#include "core/elasticity/body.hpp"

namespace palpate::published_sensing {

/// A lattice of voxels that fills an object, with springs between neighbours and the object's mesh
/// embedded in it (trilinear).
class VoxelLattice {
 public:
  struct Spring {
    int a, b;
    double length;  // m
    int kind;       // 0: along an edge of a voxel; 1: diagonal of a face; 2: through the voxel
  };

  /// `voxel`: m, side, rounded so that whole voxels fill the object's box. Throws
  /// std::invalid_argument where it is not positive, or gives more than 20000 nodes.
  VoxelLattice(const elasticity::Body& body, double voxel);

  const Eigen::Matrix3Xd& rest() const noexcept { return rest_; }  // of its nodes, m
  const std::vector<Spring>& springs() const noexcept { return springs_; }
  const std::vector<int>& fixed() const noexcept { return fixed_; }  // nodes that the clamp holds

  /// Positions of the mesh's nodes, 3 x n, from those of the lattice.
  void embed(const Eigen::Matrix3Xd& lattice, Eigen::Matrix3Xd& shape) const noexcept;
  /// Adds forces on the mesh's nodes to those on the lattice's.
  void spread(const Eigen::Matrix3Xd& on_mesh, Eigen::Matrix3Xd& on_lattice) const noexcept;

 private:
  struct Embedding {
    std::array<int, 8> nodes;
    std::array<double, 8> weights;
  };
  std::vector<Spring> springs_;
  std::vector<Embedding> embeddings_;
  std::vector<int> fixed_;
  Eigen::Matrix3Xd rest_;
};

}  // namespace palpate::published_sensing
