#pragma once

#include <filesystem>
#include <string>

#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh_tool {

/// True for .stl and .obj.
bool is_surface_file(const std::filesystem::path& file);

/// Reads Gmsh .msh (2.x, 4.1, ASCII or binary), TetGen .node/.ele (either names the pair), Vega
/// .veg or .vtu, including faulty meshes, with lengths multiplied by `scale` to m. Tetrahedra are
/// in the order of the file. Throws std::runtime_error naming file and line.
mesh::MeshWithGroups read_volume(const std::filesystem::path& file, double scale);

/// Reads .stl (ASCII or binary) or .obj.
mesh::TriangleSurface read_surface(const std::filesystem::path& file, double scale);

struct FileFormat {
  mesh::GmshFormat gmsh;  // its order applies to .vtu too, its encoding for .vtu as base64
  int first = 1;          // index of the first node, for .node/.ele and .veg
  mesh::VegaMaterial vega_material;
};

/// Writes in the format given by the extension; .node or .ele writes both; .stl and .obj get the
/// boundary. The file is written completely or not at all. Throws std::runtime_error.
void write_volume(const mesh::MeshWithGroups& mesh, const std::filesystem::path& file,
                  const FileFormat& format);
void write_surface(const mesh::TriangleSurface& surface, const std::filesystem::path& file);

/// The outward boundary of a mesh; `numbers` are indices of the tetrahedra.
mesh::TriangleSurface boundary(const mesh::TetrahedralMesh& mesh);

/// Writes to a temporary file that is then renamed. Throws std::runtime_error.
void write_file(const std::filesystem::path& file, const std::string& bytes);

}  // namespace palpate::mesh_tool
