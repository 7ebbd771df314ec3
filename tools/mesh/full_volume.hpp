#pragma once

#include "core/mesh/mesh_reader.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh_tool {

/// Finds the positions of the midpoints of a mesh's boundary edges on the surface it was made of,
/// and stores those that lie off the straight edge, so that quadratic elements follow the surface
/// and straight ones can be given its volume (mesh::keep_curved_volume). Returns their number.
int follow_surface(const mesh::TriangleSurface& surface, mesh::MeshWithGroups& mesh);

}  // namespace palpate::mesh_tool
