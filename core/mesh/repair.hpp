#pragma once

#include <string>
#include <vector>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// Treatment of elements without volume, by their numbers in the file.
struct FlatElements {
  std::vector<long> peeled;     // removed from the surface, where they covered others
  std::vector<long> inflated;   // given volume by moving interior nodes
  std::vector<long> collapsed;  // one of their edges was collapsed to a node
  std::vector<long> left;
};

/// Removes tetrahedra without volume (by the criterion of check()) such that the others remain
/// conforming and fill the same space. Other tetrahedra must be positively oriented.
FlatElements remove_flat_elements(MeshWithGroups& mesh);

/// Divides non-tetrahedral cells: pyramids into two tetrahedra, prisms into three, hexahedra into
/// twelve around a new node at their centre. A rectangle is divided at its corner with the lowest
/// number, so that neighbours match. Returns the number of divided cells; a cell with an invalid
/// node is unchanged. New tetrahedra have the number of their cell and are appended.
int split_cells(MeshWithGroups& mesh);

/// Treatment of a mesh with several parts (parts share no face; those that share only an edge or a
/// node are connected by a hinge without stiffness).
enum class Parts { kKeepAll, kKeepLargest };

struct RepairOptions {
  /// Nodes within this distance, relative to the mesh's bounding box diagonal, are merged.
  double merge_tolerance = 1e-9;
  Parts parts = Parts::kKeepAll;
};

/// One repair.
struct RepairStep {
  std::string what;           // for instance "nodes merged ..."
  std::vector<long> numbers;  // numbers of the nodes or elements in the file
};

/// Repairs faults whose intended state is unambiguous, in this order: non-tetrahedral cells are
/// divided; coincident nodes are merged; repeated elements and those that lost a corner by merging
/// are dropped; wrongly oriented elements are reversed, those inverted by a misplaced node are
/// corrected by moving nodes; elements without volume are removed from the surface, given volume by
/// moving nodes, or collapsed; small parts are dropped on request; finally nodes in no element.
/// Faults that check() still reports cannot be repaired. Groups are updated.
std::vector<RepairStep> repair(MeshWithGroups& mesh, const RepairOptions& options);

/// Part of each tetrahedron, from 0, ordered by descending volume; a part is connected by shared
/// faces.
std::vector<int> parts_by_faces(const TetrahedralMesh& mesh);

/// Drops tetrahedra and the nodes that are then unused; renumbers groups and edge midpoints.
void drop(MeshWithGroups& mesh, const std::vector<bool>& tetrahedra);

/// Replaces each node by the given one (itself, or one with a lower index) in elements and groups.
void replace_nodes(MeshWithGroups& mesh, const std::vector<int>& by);

}  // namespace palpate::mesh
