#include "core/mesh/side_groups.hpp"

#include <numeric>
#include <set>

#include "core/mesh/surface.hpp"

namespace palpate::mesh {

void group_sides(MeshWithGroups& mesh,
                 const std::function<std::string(const Eigen::Matrix3d&)>& name) {
  const Surface surface = extract_surface(make_element_mesh(mesh.mesh, ElementOrder::kLinear));
  std::map<std::string, std::vector<int>> members;
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = mesh.mesh.nodes(Eigen::all, surface.triangles.col(t));
    members[name(corners)].push_back(t);
  }
  members.erase("");
  for (const auto& [key, triangles] : members) {
    MeshGroup& group = mesh.groups[key];
    group.triangles = surface.triangles(Eigen::all, triangles);
    const std::set<int> nodes(group.triangles.reshaped().begin(), group.triangles.reshaped().end());
    group.nodes.assign(nodes.begin(), nodes.end());
  }
  MeshGroup& body = mesh.groups["body"];
  body.tetrahedra.resize(mesh.mesh.tetrahedron_count());
  std::iota(body.tetrahedra.begin(), body.tetrahedra.end(), 0);
  body.nodes.resize(mesh.mesh.node_count());
  std::iota(body.nodes.begin(), body.nodes.end(), 0);
}

}  // namespace palpate::mesh
