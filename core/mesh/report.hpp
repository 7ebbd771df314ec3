#pragma once

#include <string>
#include <vector>

#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::mesh {

/// What is wrong with a mesh. Lists hold 0-based indices in rising order. Where an index or a
/// coordinate is bad, what depends on it is not looked at.
struct MeshReport {
  int node_count = 0;
  int tetrahedron_count = 0;

  std::vector<int> index_out_of_range;  // tetrahedra that name a node which is not there
  std::vector<int> not_finite;          // nodes with a NaN or infinite coordinate
  std::vector<int> zero_volume;         // tetrahedra of at most 1e-12 of their longest edge cubed
  std::vector<int> negative_volume;     // tetrahedra; mesh::orient turns them
  std::vector<int> duplicate_nodes;     // nodes within 1e-9 of the mesh's size of another
  std::vector<int> unused_nodes;        // nodes in no tetrahedron
  std::vector<int> overlapping;         // tetrahedra on the same side of a face they share
  int parts = 0;                        // tetrahedra that share a node are of one part
  int non_manifold_edges = 0;           // surface edges with other than two triangles
  int non_manifold_nodes = 0;           // surface nodes where parts touch in that point alone

  double volume = 0;  // m^3
  double quality_min =
      0;  // radius ratio 3 r_in / r_out: 1 for a regular tetrahedron, 0 for a flat one
  double quality_mean = 0;

  /// True where mechanics can be computed on the mesh. Non-manifold edges and nodes are
  /// hinges, not an error.
  bool ok() const;
  /// One line for people: counts, volume, quality, then every fault with its first indices.
  std::string text() const;
};

MeshReport check(const TetrahedralMesh& mesh);

/// 3 r_in / r_out of tetrahedron `t`; 0 where it has no volume.
double radius_ratio(const TetrahedralMesh& mesh, int t);

}  // namespace palpate::mesh
