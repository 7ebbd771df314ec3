#include "core/mesh/element_mesh.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace palpate::mesh {

ElementMesh make_element_mesh(const TetrahedralMesh& mesh, ElementOrder order) {
  ElementMesh result;
  result.order = order;
  result.corner_count = mesh.node_count();
  result.nodes = mesh.nodes;
  result.elements = mesh.tetrahedra;
  if (order == ElementOrder::kLinear) return result;

  result.elements.resize(10, mesh.tetrahedron_count());
  result.elements.topRows<4>() = mesh.tetrahedra;
  std::map<std::pair<int, int>, int> midside;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    for (int e = 0; e < 6; ++e) {
      const int a = mesh.tetrahedra(kTetrahedronEdges[e][0], t);
      const int b = mesh.tetrahedra(kTetrahedronEdges[e][1], t);
      const int next = mesh.node_count() + static_cast<int>(midside.size());
      result.elements(4 + e, t) =
          midside.try_emplace({std::min(a, b), std::max(a, b)}, next).first->second;
    }
  }
  result.nodes.conservativeResize(3, mesh.node_count() + static_cast<int>(midside.size()));
  for (const auto& [edge, node] : midside) {
    result.nodes.col(node) = 0.5 * (mesh.nodes.col(edge.first) + mesh.nodes.col(edge.second));
  }
  return result;
}

}  // namespace palpate::mesh
