#pragma once

#include <fstream>
#include <string>

#include "core/mesh/mesh_formats.hpp"
#include "tests/support/recordings.hpp"

namespace palpate::elasticity {

/// One of the TetGen meshes of the 2018 system.
inline mesh::TetrahedralMesh thesis_mesh(const std::string& name) {
  const std::filesystem::path folder = support::recordings() / "thesis_meshes";
  std::ifstream node(folder / (name + ".node")), ele(folder / (name + ".ele"));
  mesh::TetrahedralMesh mesh = mesh::read_tetgen(node, name + ".node", ele, name + ".ele").mesh;
  mesh::orient(mesh);
  return mesh;
}

}  // namespace palpate::elasticity
