#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "core/mesh/surface.hpp"

namespace palpate::mesh {

/// Edge given by its nodes, the lower index first.
using Edge = std::pair<int, int>;
/// Face of a tetrahedron, its nodes in ascending order.
using Face = std::array<int, 3>;

/// Items 0 to count - 1, of which some are joined to sets.
class DisjointSets {
 public:
  explicit DisjointSets(int count);
  /// The item that represents the set of `item`.
  int root(int item);
  /// Joins the set of `item` to that of `to`, whose root represents both.
  void join(int item, int to) { parent_[root(item)] = root(to); }

 private:
  std::vector<int> parent_;
};

/// The face of tetrahedron `t` opposite to its corner `left_out`.
Face face_of(const TetrahedralMesh& mesh, int t, int left_out);

/// Tetrahedra at each face, ascending. Indices must be in range.
std::map<Face, std::vector<int>> tetrahedra_by_face(const TetrahedralMesh& mesh);

/// The corners of tetrahedron `t` in ascending order: equal for repeated tetrahedra.
std::array<int, 4> sorted_corners(const TetrahedralMesh& mesh, int t);

/// Boundary of linear tetrahedra.
Surface extract_surface(const TetrahedralMesh& mesh);

/// Triangles (columns) at each edge, ascending.
std::map<Edge, std::vector<int>> triangles_by_edge(const Eigen::Matrix3Xi& triangles);

/// Nodes whose triangles form more than one fan, connected by edges: the surface touches itself
/// there in a point. Ascending.
std::vector<int> pinched_nodes(const Eigen::Matrix3Xi& triangles);

/// Columns with an index outside of 0 to `count` - 1.
std::vector<int> out_of_range(const Eigen::Ref<const Eigen::MatrixXi>& elements, int count);
/// Columns with a NaN or infinite coordinate.
std::vector<int> not_finite(const Eigen::Matrix3Xd& points);

/// For each of `count` nodes, whether an element (column) names it; negative indices are ignored.
std::vector<bool> used_nodes(const Eigen::Ref<const Eigen::MatrixXi>& elements, int count);
/// The positions of `wanted` in `flags`, ascending.
std::vector<int> indices_of(const std::vector<bool>& flags, bool wanted = true);

/// New index of each item if only the flagged ones are kept, in their order; -1: dropped.
std::vector<int> new_numbers(const std::vector<bool>& keep);

}  // namespace palpate::mesh
