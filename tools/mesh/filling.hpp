#pragma once

#include <functional>
#include <ostream>

#include "tools/mesh/gmsh_program.hpp"

namespace palpate::mesh_tool {

/// Fills a closed surface by gmsh; if triangles of the requested size cannot be made, or give
/// broken elements, with the surface's own. Then moves nodes for quality, and lets the boundary
/// follow the surface: with order 2 by the midpoints of edges, with order 1 by corners that keep
/// the volume (mesh::keep_curved_volume). Quality and volume before and after go to `out`, progress
/// to the standard error. Throws as fill_by_gmsh.
mesh::MeshWithGroups fill_and_refine(const mesh::TriangleSurface& surface,
                                     const MeshingOptions& options, int order, std::ostream& out);

/// Number of nodes with 10-node elements.
int quadratic_node_count(const mesh::TetrahedralMesh& mesh);

/// A mesh for a budget of nodes, and the edge length that it was made with, m.
struct BudgetedMesh {
  mesh::MeshWithGroups mesh;
  double edge = 0;
};

/// Makes meshes with several edge lengths, m, the first one `edge`, and returns the best of those
/// with at most `most` quadratic nodes: among those with 0.75 of it or more that with the largest
/// smallest radius ratio, otherwise that with the most nodes. `make` may throw
/// std::runtime_error, which counts as no mesh. Throws std::runtime_error if no mesh is within the
/// budget, with the last error or the smallest number of nodes.
BudgetedMesh fill_within_budget(double edge, int most,
                                const std::function<mesh::MeshWithGroups(double)>& make);

}  // namespace palpate::mesh_tool
