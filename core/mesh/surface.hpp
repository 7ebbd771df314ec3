#pragma once

#include <vector>

#include "core/mesh/element_mesh.hpp"

namespace palpate::mesh {

/// Boundary of a tetrahedral mesh.
struct Surface {
  Eigen::Matrix3Xi triangles;  // corner nodes, outward normal by the right-hand rule
  std::vector<int> nodes;      // all nodes of the boundary including midside nodes, sorted
  std::vector<std::vector<int>>
      triangle_nodes;  // per triangle: 3 corners, or 3 corners + 3 midside
};

Surface extract_surface(const ElementMesh& mesh);

/// Nodes whose rest position lies in the closed box [lower, upper] (with 1e-9 m tolerance), sorted.
std::vector<int> nodes_in_box(const ElementMesh& mesh, const Eigen::Vector3d& lower,
                              const Eigen::Vector3d& upper);

}  // namespace palpate::mesh
