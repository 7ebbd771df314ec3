#pragma once

#include <array>
#include <vector>

#include "core/elasticity/body.hpp"

namespace palpate::baselines {

/// Voxel lattice that fills an object, with springs between neighbours; the object's mesh is
/// embedded by trilinear interpolation.
class VoxelLattice {
 public:
  struct Spring {
    int a, b;
    double length;  // m
    int kind;       // 0: along an edge of a voxel; 1: face diagonal; 2: voxel diagonal
  };

  /// `voxel`: m, edge length, rounded so that an integer number of voxels fills the object's box.
  /// Throws std::invalid_argument if it is not positive or results in more than 20000 nodes.
  VoxelLattice(const elasticity::Body& body, double voxel);

  const Eigen::Matrix3Xd& rest() const noexcept { return rest_; }  // rest positions of its nodes, m
  const std::vector<Spring>& springs() const noexcept { return springs_; }
  const std::vector<int>& fixed() const noexcept { return fixed_; }  // nodes at the clamp

  /// Interpolates the positions of the mesh's nodes, 3 x n, from those of the lattice.
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

}  // namespace palpate::baselines
