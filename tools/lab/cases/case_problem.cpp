#include "tools/lab/cases/case_problem.hpp"

#include <stdexcept>

#include "rt/config/node.hpp"

namespace palpate::cases {
namespace {

using Eigen::Vector3d;

const Eigen::Matrix3Xi& triangles_of(const CaseFile& c, const mesh::MeshWithGroups& mesh,
                                     const CaseRegion& region, const std::string& key) {
  const auto group = mesh.groups.find(region.group);
  if (group == mesh.groups.end() || group->second.triangles.cols() == 0) {
    std::string known;
    for (const auto& [name, g] : mesh.groups)
      if (g.triangles.cols() > 0) known += (known.empty() ? "" : ", ") + name;
    c.fail(key + ".group",
           "the mesh has no triangles in '" + region.group + "'; allowed: " + known);
  }
  return group->second.triangles;
}

void set_materials(const CaseFile& c, elasticity::Body& body) {
  body.material = c.material;
  if (c.overrides.empty()) return;
  body.element_materials.assign(body.mesh.element_count(), c.material);
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    Vector3d centroid = Vector3d::Zero();
    for (int a = 0; a < 4; ++a) centroid += body.mesh.nodes.col(body.mesh.elements(a, e)) / 4;
    for (const MaterialOverride& o : c.overrides)
      if (o.box.contains(centroid)) body.element_materials[e] = o.material;
  }
}

}  // namespace

std::optional<math::Pose> CaseProblem::hand(double share) const {
  if (!held[0]) return std::nullopt;
  const math::Pose& from = body.grasps[0].X_OG_rest;
  const math::Pose& to = *held[0];
  const Eigen::Quaterniond begin(from.linear()), end(to.linear());
  return math::make_pose(begin.slerp(share, end).toRotationMatrix(),
                         from.translation() + share * (to.translation() - from.translation()));
}

CaseProblem make_problem(const CaseFile& c, const mesh::MeshWithGroups& mesh,
                         mesh::ElementOrder order) {
  CaseProblem problem;
  elasticity::Body& body = problem.body;
  body.mesh = mesh::make_element_mesh(mesh.mesh, order);
  set_materials(c, body);
  body.gravity_O = c.gravity;
  problem.loads = Eigen::Matrix3Xd::Zero(3, body.mesh.node_count());
  try {
    if (c.fixed)
      body.fixed_nodes = SurfacePatch(body.mesh, triangles_of(c, mesh, *c.fixed, "fixed")).nodes();
    if (c.grasp) {
      const Eigen::Matrix3Xi& triangles = triangles_of(c, mesh, c.grasp->region, "grasp");
      body.grasps = {{SurfacePatch(body.mesh, triangles).nodes(), c.grasp->X_OG_rest}};
      problem.held[0] = c.grasp->X_OG;
    }
    for (std::size_t i = 0; i < c.loads.size(); ++i) {
      const CaseLoad& load = c.loads[i];
      const SurfacePatch patch(body.mesh,
                               triangles_of(c, mesh, load.region, "loads." + std::to_string(i)));
      if (load.total_force) {
        const Vector3d even = *load.total_force / patch.area();
        problem.loads += patch.nodal_forces([even](const Vector3d&) { return even; });
      } else {
        problem.loads += patch.nodal_forces(load.traction);
      }
    }
    body.check();
  } catch (const std::invalid_argument& error) {
    c.fail("fixed", error.what());
  }
  const auto load = mesh.groups.find(c.loads.empty() ? "load" : c.loads.front().region.group);
  if (load != mesh.groups.end()) problem.monitored = load->second.triangles;
  return problem;
}

}  // namespace palpate::cases
