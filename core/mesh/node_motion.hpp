#pragma once

#include <vector>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

struct NodeMotionOptions {
  int sweeps = 20;             // maximum number of sweeps over all nodes
  std::vector<int> only = {};  // these nodes only; empty: all
};

/// Moves nodes to improve the worst tetrahedron around each; also corrects elements inverted by a
/// misplaced node. The shape is preserved: interior nodes are free, nodes on a planar side slide in
/// it, those on a straight edge along it; others are fixed, as are nodes between tetrahedra of
/// different groups and next to curved sides. Returns the number of moved nodes. All indices must
/// be in range and coordinates finite.
int move_nodes(MeshWithGroups& mesh, const NodeMotionOptions& options = {});

}  // namespace palpate::mesh
