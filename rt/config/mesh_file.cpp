#include "rt/config/mesh_file.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "core/mesh/mesh_formats.hpp"
#include "rt/config/node.hpp"

namespace palpate::config {
namespace {

using std::filesystem::path;

std::ifstream open(const path& file) {
  std::ifstream stream(file);
  // neither a folder nor an endless device
  if (!stream || !std::filesystem::is_regular_file(file)) {
    throw Error(file.string() + ": cannot be read");
  }
  return stream;
}

mesh::MeshWithGroups read(const path& file) {
  const std::string extension = file.extension().string();
  std::ifstream stream = open(file);
  if (extension == ".msh") return mesh::read_gmsh(stream, file.string());
  if (extension == ".veg") {
    const auto include = [&file](const std::string& name) {
      std::ostringstream text;
      text << open(file.parent_path() / name).rdbuf();
      return text.str();
    };
    return mesh::read_vega(stream, file.string(), include);
  }
  if (extension == ".node" || extension == ".ele") {
    const path node = path(file).replace_extension(".node");
    const path ele = path(file).replace_extension(".ele");
    std::ifstream nodes = open(node), elements = open(ele);
    return {mesh::read_tetgen(nodes, node.string(), elements, ele.string()), {}, {}};
  }
  throw Error(file.string() + ": unknown kind of mesh; allowed: .node, .ele, .msh, .veg");
}

}  // namespace

mesh::MeshWithGroups load_mesh_with_groups(const std::string& file) {
  try {
    mesh::MeshWithGroups result = read(file);
    mesh::orient(result.mesh);
    mesh::keep_curved_volume(result.mesh, result.middles);
    return result;
  } catch (const mesh::ParseError& error) {
    throw Error(error.what());
  } catch (const std::invalid_argument& error) {
    throw Error(file + ": " + error.what());
  }
}

mesh::TetrahedralMesh load_mesh(const std::string& file) {
  return load_mesh_with_groups(file).mesh;
}

}  // namespace palpate::config
