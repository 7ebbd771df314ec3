#pragma once

#include <utility>
#include <vector>

#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh {

/// Pairs of triangles that meet elsewhere than in shared corners and edges: self-intersections and
/// overlaps of the surface. Triangles without area are ignored. All indices must be in range and
/// coordinates finite.
std::vector<std::pair<int, int>> find_intersections(const TriangleSurface& surface);

}  // namespace palpate::mesh
