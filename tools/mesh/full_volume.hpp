#pragma once

#include "core/mesh/mesh_reader.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh_tool {

/// Finds where the middles of a mesh's boundary edges lie on the surface that it was made of, and
/// stores those that lie off the straight edge, so that elements of order 2 follow the surface and
/// straight ones can be given its volume (mesh::keep_curved_volume). Returns how many there are.
int follow_surface(const mesh::TriangleSurface& surface, mesh::MeshWithGroups& mesh);

}  // namespace palpate::mesh_tool
