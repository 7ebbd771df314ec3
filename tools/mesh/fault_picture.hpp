#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/mesh/triangle_surface.hpp"
#include "tools/mesh/faults.hpp"

namespace palpate::mesh_tool {

/// The pale background of the faults: for a mesh of tetrahedra the boundary of the drawable ones,
/// for a surface the drawable triangles.
mesh::TriangleSurface background(const mesh::MeshWithGroups& mesh);
mesh::TriangleSurface background(const mesh::TriangleSurface& surface);

/// Draws a body with its faults to a PNG: the whole on the left, each fault marked by a ball; on
/// the right a close-up of the first of the first kind; one colour per kind, with a legend below.
/// Throws std::runtime_error if no image can be rendered.
void draw_faults(const mesh::TriangleSurface& body, const std::vector<Fault>& faults,
                 const std::string& title, const std::filesystem::path& png);

}  // namespace palpate::mesh_tool
