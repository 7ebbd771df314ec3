#include "rt/config/mesh_file.hpp"

#include <sstream>
#include <stdexcept>

#include "core/mesh/mesh_formats.hpp"
#include "core/mesh/surface_files.hpp"
#include "rt/config/node.hpp"

namespace palpate::config {

using std::filesystem::path;

std::ifstream open_file(const path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || !std::filesystem::is_regular_file(file))
    throw std::runtime_error(file.string() + ": cannot be read");
  return stream;
}

mesh::MeshWithGroups read_mesh(const std::string& name, mesh::OnFault on_fault) {
  const path file(name);
  const std::string extension = file.extension().string();
  if (extension == ".node" || extension == ".ele") {
    const path node = path(file).replace_extension(".node");
    const path ele = path(file).replace_extension(".ele");
    std::ifstream nodes = open_file(node), elements = open_file(ele);
    return mesh::read_tetgen(nodes, node.string(), elements, ele.string(), on_fault);
  }
  std::ifstream stream = open_file(file);
  if (extension == ".msh") return mesh::read_gmsh(stream, name, on_fault);
  if (extension == ".veg") {
    const auto include = [&file](const std::string& included) {
      std::ostringstream text;
      text << open_file(file.parent_path() / included).rdbuf();
      return text.str();
    };
    return mesh::read_vega(stream, name, include, on_fault);
  }
  throw std::runtime_error(name + ": unknown kind of mesh; allowed: .node, .ele, .msh, .veg");
}

mesh::MeshWithGroups load_mesh_with_groups(const std::string& file) {
  try {
    mesh::MeshWithGroups result = read_mesh(file, mesh::OnFault::kThrow);
    mesh::orient(result.mesh);
    mesh::keep_curved_volume(result.mesh, result.middles);
    return result;
  } catch (const std::runtime_error& error) {
    throw Error(error.what());
  } catch (const std::invalid_argument& error) {
    throw Error(file + ": " + error.what());
  }
}

mesh::TetrahedralMesh load_mesh(const std::string& file) {
  return load_mesh_with_groups(file).mesh;
}

mesh::TriangleSurface load_surface(const std::string& name) {
  const std::string extension = path(name).extension().string();
  try {
    std::ifstream stream = open_file(name);
    if (extension == ".stl") return mesh::read_stl(stream, name);
    if (extension == ".obj") return mesh::read_obj(stream, name);
  } catch (const std::runtime_error& error) {
    throw Error(error.what());
  }
  throw Error(name + ": unknown kind of surface; allowed: .stl, .obj");
}

}  // namespace palpate::config
