#pragma once

#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::mesh {

enum class ElementOrder { kLinear = 1, kQuadratic = 2 };

/// Corners of the edges of a tetrahedron, in the order of a quadratic element's midside nodes.
inline constexpr int kTetrahedronEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

/// Tetrahedra with the nodes required by elements of an order. The first corner_count nodes are
/// those of the linear mesh, in its order. A quadratic element lists its 4 corners, then the
/// midside nodes of edges 01, 12, 02, 03, 13, 23 (VTK's order).
struct ElementMesh {
  ElementOrder order = ElementOrder::kLinear;
  int corner_count = 0;
  Eigen::Matrix3Xd nodes;    // 3 x n rest positions in O, m
  Eigen::MatrixXi elements;  // (4 or 10) x m

  int node_count() const { return static_cast<int>(nodes.cols()); }
  int element_count() const { return static_cast<int>(elements.cols()); }
  int nodes_per_element() const { return static_cast<int>(elements.rows()); }
};

/// Adds straight-sided midside nodes for kQuadratic; copies for kLinear.
ElementMesh make_element_mesh(const TetrahedralMesh& mesh, ElementOrder order);

}  // namespace palpate::mesh
