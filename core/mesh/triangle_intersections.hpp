#pragma once

#include <utility>
#include <vector>

#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh {

/// Pairs of triangles that meet elsewhere than in corners and edges that they share: the surface
/// goes through itself, or lies on itself. Triangles without area are passed over. All indices
/// must be in range and coordinates finite.
std::vector<std::pair<int, int>> find_intersections(const TriangleSurface& surface);

}  // namespace palpate::mesh
