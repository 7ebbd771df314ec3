#pragma once

#include <map>
#include <utility>

#include "core/mesh/tetrahedral_mesh.hpp"

namespace palpate::mesh {

/// Edge midpoints from a file (m), by the edge's corners in ascending order.
using EdgeMiddles = std::map<std::pair<int, int>, Eigen::Vector3d>;

/// Straight sides between points of a curved surface reduce the volume of a body, and even more its
/// bending stiffness: a coarse cylinder loses a fifth. Moves the corners of curved boundary sides
/// outward until the volume within straight sides equals that within the curved ones; planar sides
/// remain in their plane. Tetrahedra must be positively oriented. Returns the largest displacement,
/// m; 0 without curved sides. Throws std::invalid_argument if sides are too strongly curved for
/// their size.
double keep_curved_volume(TetrahedralMesh& mesh, const EdgeMiddles& middles);

/// Volume within the boundary, m^3, with sides curved through their edge midpoints (edges that are
/// not listed are straight).
double curved_volume(const TetrahedralMesh& mesh, const EdgeMiddles& middles);

}  // namespace palpate::mesh
