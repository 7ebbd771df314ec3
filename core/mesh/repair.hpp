#pragma once

#include <string>
#include <vector>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

/// What is to become of a mesh in several parts (parts share no face; those that share an edge or a
/// node alone hang on a hinge without stiffness).
enum class Parts { kKeepAll, kKeepLargest };

struct RepairOptions {
  double merge_tolerance = 1e-9;  // nodes so near are one, by the diagonal of the mesh's box
  Parts parts = Parts::kKeepAll;
};

/// One thing that was mended.
struct RepairStep {
  std::string what;           // "nodes merged ...", with how
  std::vector<long> numbers;  // of the nodes or elements in the file
};

/// Mends what can be mended without a guess at what was meant, in this order: cells that are no
/// tetrahedra are cut; nodes that lie on another are merged; elements that are there twice, or lost
/// a corner by merging, are dropped; elements turned inside out are turned back, those that a
/// strayed node turned inside out by moving nodes; elements without volume are peeled off the
/// surface, given volume by moving nodes, or collapsed; small parts are dropped where that is asked
/// for; then nodes in no element. What check() still finds cannot be mended. Groups follow.
std::vector<RepairStep> repair(MeshWithGroups& mesh, const RepairOptions& options);

/// Part of each tetrahedron, from 0, the one with most volume first: of one part are those that
/// share faces.
std::vector<int> parts_by_faces(const TetrahedralMesh& mesh);

/// Drops tetrahedra, and the nodes that then are in none; renumbers groups and middles.
void drop(MeshWithGroups& mesh, const std::vector<bool>& tetrahedra);

/// Makes every node stand for the one given (itself, or one with a lower index), which takes its
/// place in elements and groups.
void replace_nodes(MeshWithGroups& mesh, const std::vector<int>& by);

}  // namespace palpate::mesh
