#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/mesh/triangle_surface.hpp"
#include "tools/mesh/faults.hpp"

namespace palpate::mesh_tool {

/// What is drawn pale round the faults: of a mesh of tetrahedra the boundary of those that can be
/// drawn, of a surface the triangles that can be.
mesh::TriangleSurface background(const mesh::MeshWithGroups& mesh);
mesh::TriangleSurface background(const mesh::TriangleSurface& surface);

/// Draws a body with its faults to a PNG: the whole on the left, each fault marked by a ball; on
/// the right the first of the first kind from near; a colour for each kind, named below. Throws
/// std::runtime_error where no picture can be made.
void draw_faults(const mesh::TriangleSurface& body, const std::vector<Fault>& faults,
                 const std::string& title, const std::filesystem::path& png);

}  // namespace palpate::mesh_tool
