#include "core/mesh/subdivision.hpp"

#include <stdexcept>
#include <utility>

namespace palpate::mesh {
namespace {

// Places in a quadratic element.
constexpr int kCorners[4][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3}};
/// Diagonal of the octahedron of the middles, and the other four of them around it.
struct Split {
  int from, to;
  int ring[4];
};
constexpr Split kSplits[3] = {{4, 9, {5, 6, 7, 8}}, {5, 7, {4, 6, 9, 8}}, {6, 8, {4, 5, 9, 7}}};

}  // namespace

TetrahedralMesh subdivide(const ElementMesh& quadratic) {
  if (quadratic.order != ElementOrder::kQuadratic)
    throw std::invalid_argument("subdivide: elements must be quadratic");
  TetrahedralMesh mesh;
  mesh.nodes = quadratic.nodes;
  mesh.tetrahedra.resize(4, 8 * quadratic.element_count());
  for (int e = 0; e < quadratic.element_count(); ++e) {
    const auto node = quadratic.elements.col(e);
    int t = 8 * e;
    const auto add = [&](int a, int b, int c, int d) {
      mesh.tetrahedra.col(t++) << node[a], node[b], node[c], node[d];
    };
    for (const auto& c : kCorners) add(c[0], c[1], c[2], c[3]);
    const auto length = [&](const Split& split) {
      return (mesh.nodes.col(node[split.to]) - mesh.nodes.col(node[split.from])).squaredNorm();
    };
    const Split* shortest = kSplits;
    for (const Split& split : kSplits) {
      if (length(split) < length(*shortest)) shortest = &split;
    }
    for (int i = 0; i < 4; ++i)
      add(shortest->from, shortest->to, shortest->ring[i], shortest->ring[(i + 1) % 4]);
  }
  orient(mesh);
  return mesh;
}

TetrahedralMesh subdivide(const TetrahedralMesh& mesh) {
  return subdivide(make_element_mesh(mesh, ElementOrder::kQuadratic));
}

}  // namespace palpate::mesh
