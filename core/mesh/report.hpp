#pragma once

#include <string>
#include <vector>

#include "core/mesh/connectivity.hpp"

namespace palpate::mesh {

/// Faults of a mesh. Lists contain 0-based indices in ascending order. Where an index or a
/// coordinate is invalid, dependent checks are skipped.
struct MeshReport {
  int node_count = 0;
  int tetrahedron_count = 0;

  std::vector<int> index_out_of_range;  // tetrahedra that refer to a missing node
  std::vector<int> not_finite;          // nodes with a NaN or infinite coordinate
  /// Tetrahedra with a volume of at most 1e-12 of their longest edge cubed.
  std::vector<int> zero_volume;
  std::vector<int> negative_volume;  // inverted tetrahedra; mesh::orient reverses them
  std::vector<int> duplicate_nodes;  // nodes nearer to another than 1e-9 of the mesh's size
  std::vector<int> unused_nodes;     // nodes in no tetrahedron
  std::vector<int> overlapping;      // tetrahedra on the same side of a shared face
  /// Number of parts; tetrahedra that share a node are of one part.
  int parts = 0;
  std::vector<Edge> non_manifold_edges;  // of the surface: of other than two triangles
  std::vector<int> non_manifold_nodes;   // of the surface: parts touch in this point only

  double volume = 0;  // m^3
  double quality_min =
      0;  // radius ratio 3 r_in / r_out: 1 for a regular tetrahedron, 0 for a flat one
  double quality_mean = 0;

  /// True if the mesh is suitable for mechanics. Non-manifold edges and nodes act as hinges and are
  /// not an error.
  bool ok() const;
  /// One-line summary: counts, volume, quality, then every fault with its first indices.
  std::string text() const;
};

MeshReport check(const TetrahedralMesh& mesh);

/// 3 r_in / r_out of tetrahedron `t`; 0 if it has no volume.
double radius_ratio(const TetrahedralMesh& mesh, int t);

}  // namespace palpate::mesh
