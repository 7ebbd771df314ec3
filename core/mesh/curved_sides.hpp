#pragma once

#include <map>
#include <utility>

#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::mesh {

/// Where a file puts the middle of an edge (m), by the edge's corners in rising order.
using EdgeMiddles = std::map<std::pair<int, int>, Eigen::Vector3d>;

/// Straight sides between points of a round surface cut volume off a body, and the more of its
/// bending stiffness: a coarse cylinder loses a fifth. Moves the corners of curved boundary sides
/// outward until straight ones hold the volume that the curved ones held; sides that are flat keep
/// their plane. Tetrahedra must be positive. Largest distance moved, m; 0 where no side is curved.
/// Throws std::invalid_argument where sides are curved too much for their size.
double keep_curved_volume(TetrahedralMesh& mesh, const EdgeMiddles& middles);

/// Volume within the boundary, m^3, its sides bent through the middles of their edges (edges that
/// are not listed are straight).
double curved_volume(const TetrahedralMesh& mesh, const EdgeMiddles& middles);

}  // namespace palpate::mesh
