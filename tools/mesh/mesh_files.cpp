#include "tools/mesh/mesh_files.hpp"

#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "core/mesh/connectivity.hpp"
#include "core/mesh/surface_files.hpp"
#include "rt/config/mesh_file.hpp"

namespace palpate::mesh_tool {
namespace {

using std::filesystem::path;

constexpr char kVolumes[] = ".msh, .node, .ele, .veg, .vtu";

bool is_volume_file(const path& file) {
  const std::string extension = file.extension().string();
  return extension == ".msh" || extension == ".node" || extension == ".ele" || extension == ".veg";
}

}  // namespace

bool is_surface_file(const path& file) {
  return file.extension() == ".stl" || file.extension() == ".obj";
}

mesh::MeshWithGroups read_volume(const path& file, double scale) {
  mesh::MeshWithGroups result;
  if (file.extension() == ".vtu") {
    std::ifstream stream = config::open_file(file);
    result = read_vtu(stream, file.string(), mesh::OnFault::kKeep);
  } else if (is_volume_file(file)) {
    result = config::read_mesh(file.string(), mesh::OnFault::kKeep);
  } else {
    throw std::runtime_error(file.string() + ": unknown kind of mesh; allowed: " + kVolumes);
  }
  if (scale != 1) {
    result.mesh.nodes *= scale;
    for (auto& [edge, middle] : result.middles) middle *= scale;
  }
  return result;
}

mesh::TriangleSurface read_surface(const path& file, double scale) {
  std::ifstream stream = config::open_file(file);
  if (!is_surface_file(file))
    throw std::runtime_error(file.string() + ": unknown kind of surface; allowed: .stl, .obj");
  mesh::TriangleSurface surface = file.extension() == ".stl"
                                      ? mesh::read_stl(stream, file.string())
                                      : mesh::read_obj(stream, file.string());
  surface.points *= scale;
  return surface;
}

mesh::TriangleSurface boundary(const mesh::TetrahedralMesh& mesh) {
  const mesh::Surface outside = mesh::extract_surface(mesh);
  mesh::TriangleSurface surface;
  surface.points = mesh.nodes(Eigen::all, outside.nodes);
  const std::vector<int> number =
      mesh::new_numbers(mesh::used_nodes(outside.triangles, mesh.node_count()));
  surface.triangles = outside.triangles.unaryExpr([&](int n) { return number[n]; });
  return surface;
}

void write_file(const path& file, const std::string& bytes) {
  const path temporary = file.string() + ".part" + std::to_string(getpid());
  {
    std::ofstream out(temporary, std::ios::binary);
    out << bytes;
    if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
  }
  std::error_code error;
  std::filesystem::rename(temporary, file, error);
  if (error) throw std::runtime_error(file.string() + ": " + error.message());
}

void write_volume(const mesh::MeshWithGroups& mesh, const path& file, const FileFormat& format) {
  const std::string extension = file.extension().string();
  if (is_surface_file(file)) return write_surface(boundary(mesh.mesh), file);
  std::ostringstream out;
  if (format.gmsh.order == mesh::ElementOrder::kQuadratic && extension != ".msh" &&
      extension != ".vtu") {
    throw std::runtime_error(file.string() + ": elements of order 2 go into .msh and .vtu only");
  }
  if (extension == ".msh") {
    mesh::write_gmsh(mesh, format.gmsh, out);
  } else if (extension == ".veg") {
    mesh::write_vega(mesh, format.vega_material, format.first, out);
  } else if (extension == ".vtu") {
    write_vtu(mesh, format.gmsh.order,
              format.gmsh.encoding == mesh::Encoding::kBinary ? VtuEncoding::kBase64
                                                              : VtuEncoding::kAscii,
              out);
  } else if (extension == ".node" || extension == ".ele") {
    std::ostringstream ele;
    mesh::write_tetgen(mesh.mesh, format.first, out, ele);
    write_file(path(file).replace_extension(".ele"), ele.str());
    return write_file(path(file).replace_extension(".node"), out.str());
  } else {
    throw std::runtime_error(file.string() + ": unknown kind of mesh; allowed: " + kVolumes +
                             ", and .stl, .obj for the boundary");
  }
  write_file(file, out.str());
}

void write_surface(const mesh::TriangleSurface& surface, const path& file) {
  std::ostringstream out;
  file.extension() == ".stl" ? mesh::write_stl(surface, out) : mesh::write_obj(surface, out);
  write_file(file, out.str());
}

}  // namespace palpate::mesh_tool
