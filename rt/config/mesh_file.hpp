#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "core/mesh/mesh_reader.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::config {

/// Opens a file, which is neither a folder nor an endless device. Throws std::runtime_error.
std::ifstream open_file(const std::filesystem::path& file);

/// Reads a tetrahedral mesh; the extension selects the parser: TetGen .node or .ele (either names
/// the pair), Gmsh .msh (2.x and 4.1, ASCII or binary), Vega .veg; palpate-mesh converts and
/// repairs others. Lengths in the file are m. The resulting tetrahedra are positively oriented;
/// those with curved sides (Gmsh's 10-node ones) become straight-sided with the same volume
/// (keep_curved_volume). Throws Error naming file and line.
mesh::TetrahedralMesh load_mesh(const std::string& path);

/// The mesh as it is in the file. Throws std::runtime_error naming file and line: ParseError if its
/// content cannot be read.
mesh::MeshWithGroups read_mesh(const std::string& path, mesh::OnFault on_fault);

/// Same, with the named groups in Gmsh and Vega files.
mesh::MeshWithGroups load_mesh_with_groups(const std::string& path);

/// The surface in an .stl or .obj file. Throws Error naming the file.
mesh::TriangleSurface load_surface(const std::string& path);

}  // namespace palpate::config
