#include "tools/fit/simulators/simulator_files.hpp"

#include <filesystem>

#include "core/mesh/mesh_writer.hpp"

namespace palpate::fit {

std::vector<std::string> remarks(const SoftObject& object) {
  std::vector<std::string> lines = {
      "Object of palpate's configuration " +
          std::filesystem::path(object.configuration).filename().string() +
          ": linear tetrahedra, in m, in the robot's base.",
      "model.json has the positions under weight that palpate computes, for comparison."};
  for (const std::string& what : object.left_out) lines.push_back("Left out: " + what + '.');
  return lines;
}

std::string words(const Eigen::Vector3d& v) {
  using mesh::shortest;
  return shortest(v.x()) + ' ' + shortest(v.y()) + ' ' + shortest(v.z());
}

void write_vtk(const SoftObject& object, std::ostream& out) {
  const mesh::TetrahedralMesh& mesh = object.mesh;
  out << "# vtk DataFile Version 3.0\nobject\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS "
      << mesh.node_count() << " double\n";
  for (const auto& node : mesh.nodes.colwise()) out << words(node) << '\n';
  out << "CELLS " << mesh.tetrahedron_count() << ' ' << 5 * mesh.tetrahedron_count() << '\n';
  for (const auto& corner : mesh.tetrahedra.colwise())
    out << "4 " << corner[0] << ' ' << corner[1] << ' ' << corner[2] << ' ' << corner[3] << '\n';
  out << "CELL_TYPES " << mesh.tetrahedron_count() << '\n';
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) out << "10\n";
}

}  // namespace palpate::fit
