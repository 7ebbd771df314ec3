#pragma once

#include <algorithm>
#include <cmath>

#include "core/elasticity/body.hpp"

namespace palpate::elasticity {

/// Nodes whose rest coordinate along `axis` is `value`.
inline std::vector<int> nodes_at(const mesh::ElementMesh& mesh, int axis, double value) {
  std::vector<int> nodes;
  for (int i = 0; i < mesh.node_count(); ++i) {
    if (std::abs(mesh.nodes(axis, i) - value) < 1e-7) nodes.push_back(i);
  }
  return nodes;
}

/// A box along x, fixed at x = 0, with a grasp of the nodes of its other end.
inline Body make_bar(const Eigen::Vector3d& size, const std::array<int, 3>& cells,
                     mesh::ElementOrder order, const Material& material = {1e5, 0.35, 300}) {
  Body body;
  body.mesh = mesh::make_element_mesh(mesh::make_box(size, cells), order);
  body.material = material;
  body.fixed_nodes = nodes_at(body.mesh, 0, 0);
  GraspRegion grasp;
  grasp.nodes = nodes_at(body.mesh, 0, size.x());
  grasp.X_OG_rest.translation() = Eigen::Vector3d(size.x(), size.y() / 2, size.z() / 2);
  body.grasps = {grasp};
  return body;
}

/// Area associated with each node of the face x = `value`: the integral of its shape function, m^2.
inline Eigen::VectorXd face_areas(const mesh::ElementMesh& mesh, double value) {
  constexpr int kFaces[4][6] = {
      {0, 1, 2, 4, 5, 6}, {0, 1, 3, 4, 8, 7}, {0, 2, 3, 6, 9, 7}, {1, 2, 3, 5, 9, 8}};
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.node_count());
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (const auto& face : kFaces) {
      Eigen::Matrix3d p;
      for (int k = 0; k < 3; ++k) p.col(k) = mesh.nodes.col(mesh.elements(face[k], e));
      if (((p.row(0).array() - value).abs() > 1e-7).any()) continue;
      const double area = 0.5 * (p.col(1) - p.col(0)).cross(p.col(2) - p.col(0)).norm();
      const bool linear = mesh.order == mesh::ElementOrder::kLinear;
      for (int k = 0; k < 3; ++k) areas(mesh.elements(face[linear ? k : k + 3], e)) += area / 3;
    }
  }
  return areas;
}

/// Nodal forces of a uniform traction on the face x = `value`.
inline Eigen::Matrix3Xd face_load(const mesh::ElementMesh& mesh, double value,
                                  const Eigen::Vector3d& force) {
  const Eigen::VectorXd areas = face_areas(mesh, value);
  return force * (areas / areas.sum()).transpose();
}

/// Mean displacement of the face x = `value`, weighted by area.
inline Eigen::Vector3d face_displacement(const mesh::ElementMesh& mesh, double value,
                                         const Eigen::Matrix3Xd& positions) {
  const Eigen::VectorXd areas = face_areas(mesh, value);
  return (positions - mesh.nodes) * areas / areas.sum();
}

inline Eigen::Matrix3d rotation(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

}  // namespace palpate::elasticity
