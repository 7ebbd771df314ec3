#include "tools/export/mesh_edges.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "tools/export/element_gradients.hpp"

namespace palpate::exporting {
namespace {

/// Nodes at the centres of faces and of 27-node hexahedra.
std::vector<char> inner_nodes(const log::MeshMessage& mesh) {
  std::vector<char> inner(static_cast<std::size_t>(mesh.nodes.cols()), 0);
  if (mesh.elements.rows() != 27) return inner;
  for (Eigen::Index e = 0; e < mesh.elements.cols(); ++e) {
    Eigen::Matrix3Xd nodes(3, 27);
    for (int i = 0; i < 27; ++i) nodes.col(i) = mesh.nodes.col(mesh.elements(i, e));
    const Eigen::Matrix3Xi places = grid_places(nodes);
    for (int i = 0; i < 27; ++i)
      if ((places.col(i).array() == 1).count() > 1)
        inner[static_cast<std::size_t>(mesh.elements(i, e))] = 1;
  }
  return inner;
}

}  // namespace

Eigen::Matrix2Xi surface_edges(const log::MeshMessage& mesh, Edges which) {
  const double crease = std::cos(40 * M_PI / 180);
  const std::vector<char> inner = inner_nodes(mesh);
  std::map<std::pair<int, int>, std::vector<Eigen::Vector3d>> normals;
  for (const auto& triangle : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.nodes.col(triangle[0]), b = mesh.nodes.col(triangle[1]),
                          c = mesh.nodes.col(triangle[2]);
    for (int i = 0; i < 3; ++i)
      normals[std::minmax(int{triangle[i]}, int{triangle[(i + 1) % 3]})].push_back(
          (b - a).cross(c - a).normalized());
  }
  std::vector<std::pair<int, int>> chosen;
  for (const auto& [edge, sides] : normals) {
    if (inner[static_cast<std::size_t>(edge.first)] || inner[static_cast<std::size_t>(edge.second)])
      continue;
    const bool is_sharp = sides.size() != 2 || sides[0].dot(sides[1]) < crease;
    // Diagonals of a face between the midpoints of its edges are not parallel to any axis of its
    // box.
    const Eigen::Vector3d along =
        (mesh.nodes.col(edge.first) - mesh.nodes.col(edge.second)).cwiseAbs();
    const bool is_diagonal = mesh.elements.rows() == 27 && along.maxCoeff() < 0.999 * along.norm();
    if (which == Edges::kSharp ? is_sharp : !is_diagonal) chosen.push_back(edge);
  }
  Eigen::Matrix2Xi columns(2, static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i)
    columns.col(static_cast<Eigen::Index>(i)) << chosen[i].first, chosen[i].second;
  return columns;
}

}  // namespace palpate::exporting
