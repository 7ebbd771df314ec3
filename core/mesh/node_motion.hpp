#pragma once

#include <vector>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::mesh {

struct NodeMotionOptions {
  int sweeps = 20;             // over all nodes, at most
  std::vector<int> only = {};  // these nodes alone; empty: all
};

/// Moves nodes so that the worst tetrahedron about each becomes better; one that is inside out
/// because a node strayed comes right again. The shape stays: nodes inside are free, those on a
/// flat side slide in it, those on a straight edge along it, others stand still, as do nodes where
/// tetrahedra of different groups meet and those beside curved sides. Returns how many nodes were
/// moved. All indices must be in range and coordinates finite.
int move_nodes(MeshWithGroups& mesh, const NodeMotionOptions& options = {});

}  // namespace palpate::mesh
