#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <random>
#include <vector>

#include "core/mesh/grid_mesh.hpp"

namespace palpate::mesh {

/// Meshes of all kinds found in files: boxes and grids with cells removed, divided in two ways,
/// nodes moved by up to a sixth of a cell, arbitrarily rotated, in mm or m, with any numbering.
class RandomMeshes {
 public:
  explicit RandomMeshes(unsigned seed) : random_(seed) {}

  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  double between(double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random_);
  }

  TetrahedralMesh make() {
    GridPlanes planes;
    double smallest = 1;
    for (auto& axis : planes) {
      axis.push_back(between(-1, 1));
      for (int i = 1 + below(4); i > 0; --i) {
        const double cell = between(0.2, 1);
        smallest = std::min(smallest, cell);
        axis.push_back(axis.back() + cell);
      }
    }
    TetrahedralMesh mesh = make_grid(planes, below(2) == 0 ? CellCut::kSix : CellCut::kFive);
    // A part stays connected: no two inner nodes coincide, and no tetrahedron is inverted.
    for (double& coordinate : mesh.nodes.reshaped()) coordinate += between(-1, 1) * smallest / 12;
    const Eigen::Vector3d axis(between(-1, 1), between(-1, 1), 1);
    const double scale = below(2) == 0 ? 1e-3 : 0.1;
    const Eigen::Matrix3d turned =
        Eigen::AngleAxisd(between(0, 3), axis.normalized()).toRotationMatrix();
    mesh.nodes = scale * turned * mesh.nodes;
    renumber(mesh);
    return mesh;
  }

 private:
  void renumber(TetrahedralMesh& mesh) {
    std::vector<int> number(mesh.node_count());
    for (int n = 0; n < mesh.node_count(); ++n) number[n] = n;
    std::shuffle(number.begin(), number.end(), random_);
    const Eigen::Matrix3Xd nodes = mesh.nodes;
    for (int n = 0; n < mesh.node_count(); ++n) mesh.nodes.col(number[n]) = nodes.col(n);
    for (int& index : mesh.tetrahedra.reshaped()) index = number[index];
  }

  std::mt19937 random_;
};

}  // namespace palpate::mesh
