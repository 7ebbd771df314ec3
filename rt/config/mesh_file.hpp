#pragma once

#include <string>

#include "core/mesh/mesh_reader.hpp"

namespace palpate::config {

/// Reads a tetrahedral mesh, its parser chosen by the extension: TetGen .node or .ele (either names
/// the pair), Gmsh .msh (2.x and 4.1, ASCII or binary), Vega .veg; palpate-mesh converts and
/// repairs others. Lengths in the file are m. Tetrahedra come out positively oriented, those with
/// curved sides (Gmsh's 10-node ones) straight but with the volume that they held
/// (keep_curved_volume). Throws Error that names file and line.
mesh::TetrahedralMesh load_mesh(const std::string& path);

/// Same, with the named groups that Gmsh and Vega files hold.
mesh::MeshWithGroups load_mesh_with_groups(const std::string& path);

}  // namespace palpate::config
