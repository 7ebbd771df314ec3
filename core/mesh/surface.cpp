#include "core/mesh/surface.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace palpate::mesh {
namespace {

// Faces seen from outside, corners counter-clockwise, with the midside nodes of edges 01, 12, 20 of
// the face (local positions in a quadratic element).
struct FaceCorners {
  int corners[3];
  int midside[3];
};
constexpr FaceCorners kFaces[4] = {
    {{0, 2, 1}, {6, 5, 4}}, {{0, 1, 3}, {4, 8, 7}}, {{1, 2, 3}, {5, 9, 8}}, {{0, 3, 2}, {7, 9, 6}}};

}  // namespace

Surface extract_surface(const ElementMesh& mesh) {
  struct Place {
    int element;
    int face;
    int count;
  };
  std::map<std::array<int, 3>, Place> faces;
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (int f = 0; f < 4; ++f) {
      std::array<int, 3> key;
      for (int i = 0; i < 3; ++i) key[i] = mesh.elements(kFaces[f].corners[i], e);
      std::sort(key.begin(), key.end());
      ++faces.try_emplace(key, Place{e, f, 0}).first->second.count;
    }
  }
  Surface surface;
  std::set<int> nodes;
  for (const auto& [key, place] : faces) {
    if (place.count != 1) continue;
    const FaceCorners& face = kFaces[place.face];
    std::vector<int> members;
    for (int corner : face.corners) members.push_back(mesh.elements(corner, place.element));
    if (mesh.order == ElementOrder::kQuadratic) {
      for (int node : face.midside) members.push_back(mesh.elements(node, place.element));
    }
    nodes.insert(members.begin(), members.end());
    surface.triangle_nodes.push_back(std::move(members));
  }
  surface.nodes.assign(nodes.begin(), nodes.end());
  surface.triangles.resize(3, static_cast<int>(surface.triangle_nodes.size()));
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i) surface.triangles(i, t) = surface.triangle_nodes[t][i];
  }
  return surface;
}

std::vector<int> nodes_in_box(const ElementMesh& mesh, const Eigen::Vector3d& lower,
                              const Eigen::Vector3d& upper) {
  constexpr double kTolerance = 1e-9;
  std::vector<int> nodes;
  for (int n = 0; n < mesh.node_count(); ++n) {
    const Eigen::Vector3d p = mesh.nodes.col(n);
    if ((p.array() >= lower.array() - kTolerance).all() &&
        (p.array() <= upper.array() + kTolerance).all()) {
      nodes.push_back(n);
    }
  }
  return nodes;
}

}  // namespace palpate::mesh
