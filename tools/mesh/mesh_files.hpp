#pragma once

#include <filesystem>
#include <string>

#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/triangle_surface.hpp"

namespace palpate::mesh_tool {

/// True for .stl and .obj.
bool is_surface_file(const std::filesystem::path& file);

/// Reads Gmsh .msh (2.x, 4.1, ASCII or binary), TetGen .node/.ele (either names the pair), Vega
/// .veg or .vtu, faults and all, its lengths multiplied by `scale` to be m. Tetrahedra stand as in
/// the file. Throws std::runtime_error that names file and line.
mesh::MeshWithGroups read_volume(const std::filesystem::path& file, double scale);

/// Reads .stl (ASCII or binary) or .obj.
mesh::TriangleSurface read_surface(const std::filesystem::path& file, double scale);

struct FileFormat {
  mesh::GmshFormat gmsh;  // its order holds for .vtu too, its encoding for .vtu as base64
  int first = 1;          // number of the first node, of .node/.ele and .veg
  mesh::VegaMaterial vega_material;
};

/// Writes in the format that the extension says; .node or .ele writes both; .stl and .obj get the
/// boundary. The file appears whole or not at all. Throws std::runtime_error.
void write_volume(const mesh::MeshWithGroups& mesh, const std::filesystem::path& file,
                  const FileFormat& format);
void write_surface(const mesh::TriangleSurface& surface, const std::filesystem::path& file);

/// The outward boundary of a mesh; `numbers` are indices of the tetrahedra.
mesh::TriangleSurface boundary(const mesh::TetrahedralMesh& mesh);

/// Writes by way of a file beside it that then takes its name. Throws std::runtime_error.
void write_file(const std::filesystem::path& file, const std::string& bytes);

}  // namespace palpate::mesh_tool
