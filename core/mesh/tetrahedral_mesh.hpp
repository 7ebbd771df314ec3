#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate::mesh {

/// Linear tetrahedra as stored in files. nodes: 3 x n rest positions in O, m. tetrahedra: 4 x m
/// 0-based node indices, positively oriented: (x1-x0) . ((x2-x0) x (x3-x0)) > 0.
struct TetrahedralMesh {
  Eigen::Matrix3Xd nodes;
  Eigen::Matrix4Xi tetrahedra;

  int node_count() const { return static_cast<int>(nodes.cols()); }
  int tetrahedron_count() const { return static_cast<int>(tetrahedra.cols()); }
};

/// 64-bit FNV-1a hash of counts, node coordinates and indices: identifies a mesh in messages.
std::int64_t hash(const TetrahedralMesh& mesh);

/// Box [0, size] with `cells` per axis, each cell divided into six tetrahedra (Kuhn), so that faces
/// match.
TetrahedralMesh make_box(const Eigen::Vector3d& size, const std::array<int, 3>& cells);

/// Volume of tetrahedron `t`, m^3, negative if it is inverted.
double volume(const TetrahedralMesh& mesh, int t);

/// Reverses every negatively oriented tetrahedron and returns their number. Files differ in their
/// convention.
int orient(TetrahedralMesh& mesh);

}  // namespace palpate::mesh
