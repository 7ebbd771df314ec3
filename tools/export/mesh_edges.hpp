#pragma once

#include <Eigen/Core>

#include "tools/log/plant_truth.hpp"

namespace palpate::exporting {

/// Edges of the elements on the surface of a mesh, as columns of two nodes; for hexahedra without
/// the lines through their faces. kSharp: edges at which the rest surface turns by more than 40
/// deg.
enum class Edges { kAll, kSharp };
Eigen::Matrix2Xi surface_edges(const log::MeshMessage& mesh, Edges which);

}  // namespace palpate::exporting
