#include "core/mesh/mesh_writer.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace palpate::mesh {

std::string shortest(double value) {
  char text[40];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return error == std::errc() ? std::string(text, end) : "nan";
}

ElementMesh element_mesh(const MeshWithGroups& mesh, ElementOrder order) {
  ElementMesh result = make_element_mesh(mesh.mesh, order);
  if (order == ElementOrder::kLinear || mesh.middles.empty()) return result;
  for (int t = 0; t < result.element_count(); ++t) {
    for (int e = 0; e < 6; ++e) {
      const auto found =
          mesh.middles.find(std::minmax(result.elements(kTetrahedronEdges[e][0], t),
                                        result.elements(kTetrahedronEdges[e][1], t)));
      if (found != mesh.middles.end()) result.nodes.col(result.elements(4 + e, t)) = found->second;
    }
  }
  return result;
}

void write_tetgen(const TetrahedralMesh& mesh, int first, std::ostream& node, std::ostream& ele) {
  if (first != 0 && first != 1) throw std::invalid_argument("numbers begin at 0 or 1");
  node << mesh.node_count() << " 3 0 0\n";
  for (int n = 0; n < mesh.node_count(); ++n) {
    node << first + n;
    for (int i = 0; i < 3; ++i) node << ' ' << shortest(mesh.nodes(i, n));
    node << '\n';
  }
  ele << mesh.tetrahedron_count() << " 4 0\n";
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    ele << first + t;
    for (int i = 0; i < 4; ++i) ele << ' ' << first + mesh.tetrahedra(i, t);
    ele << '\n';
  }
}

void write_vega(const MeshWithGroups& mesh, const VegaMaterial& material, int first,
                std::ostream& out) {
  out << "# numbers from " << first << ", lengths in m\n\n*VERTICES\n";
  // TetGen's pair in one stream, with the header of the element section in between.
  const TetrahedralMesh nodes{mesh.mesh.nodes, Eigen::Matrix4Xi(4, 0)};
  struct Nowhere : std::streambuf {
    int overflow(int c) override { return c; }
  } nowhere;
  std::ostream none(&nowhere);
  write_tetgen(nodes, first, out, none);
  out << "\n*ELEMENTS\nTETS\n";
  write_tetgen(mesh.mesh, first, none, out);
  for (const auto& [name, group] : mesh.groups) {
    if (group.tetrahedra.empty()) continue;
    std::string word = name;  // Vega requires single-word names
    std::replace_if(
        word.begin(), word.end(), [](unsigned char c) { return c <= ' ' || c == ','; }, '_');
    out << "\n*SET " << word << '\n';
    for (std::size_t i = 0; i < group.tetrahedra.size(); ++i) {
      out << first + group.tetrahedra[i]
          << (i + 1 == group.tetrahedra.size() ? "\n"
              : i % 16 == 15                   ? ",\n"
                                               : ", ");
    }
  }
  out << "\n*MATERIAL MATERIAL\nENU, " << shortest(material.density) << ", "
      << shortest(material.young_modulus) << ", " << shortest(material.poisson_ratio)
      << "\n\n*REGION\nallElements, MATERIAL\n";
}

}  // namespace palpate::mesh
