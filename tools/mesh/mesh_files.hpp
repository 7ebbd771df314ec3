#pragma once

#include <filesystem>
#include <istream>
#include <ostream>
#include <string>

#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/triangle_surface.hpp"
#include "tools/common/vtu_writer.hpp"

namespace palpate::mesh_tool {

/// Reads VTK's unstructured grid in XML (.vtu): tetrahedra of 4 and 10 nodes; other solids as
/// OnFault specifies; triangles, lines and points are ignored. Data as ASCII, base64 inline or
/// appended, or raw appended; zlib or none; little-endian. Integer cell data whose names begin with
/// "group:" become groups. Throws mesh::ParseError.
mesh::MeshWithGroups read_vtu(std::istream& stream, const std::string& name,
                              mesh::OnFault on_fault);

using common::VtuEncoding;

/// Writes the same, with the elements' radius ratio as cell data "quality", and one array of 0 and
/// 1 for each group of tetrahedra.
void write_vtu(const mesh::MeshWithGroups& mesh, mesh::ElementOrder order, VtuEncoding encoding,
               std::ostream& out);

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
