#pragma once

#include <functional>

#include "core/mesh/element_mesh.hpp"

namespace palpate::cases {

/// Part of a mesh's surface as faces of its elements: integrals over it, at rest.
class SurfacePatch {
 public:
  /// triangles: corner nodes, three of one tetrahedron each. Throws std::invalid_argument if the
  /// mesh has no such edge. The mesh must outlive the patch.
  SurfacePatch(const mesh::ElementMesh& mesh, const Eigen::Matrix3Xi& triangles);
  SurfacePatch(mesh::ElementMesh&&, const Eigen::Matrix3Xi&) = delete;

  bool empty() const { return faces_.cols() == 0; }
  std::vector<int> nodes() const;  // sorted; including midside nodes
  double area() const;             // m^2

  /// Consistent nodal forces (3 x n, N) of a traction (Pa) given as a function of rest position.
  Eigen::Matrix3Xd nodal_forces(
      const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& traction) const;

  /// Area-weighted mean of the displacements u (3 x n).
  Eigen::Vector3d mean(const Eigen::Matrix3Xd& u) const;

  /// In-plane rotation of the patch (rad, about the coordinate axis nearest to the normal): the
  /// best fit of its nodes, weighted by their areas.
  double twist(const Eigen::Matrix3Xd& positions) const;

 private:
  /// visit(area weight in m^2, shape functions of the face's nodes, face).
  using Visit = std::function<void(double, const Eigen::VectorXd&, int)>;
  void integrate(const Visit& visit) const;
  Eigen::VectorXd nodal_areas() const;  // integrals of the shape functions, m^2

  const mesh::ElementMesh& mesh_;
  Eigen::MatrixXi faces_;  // (3 or 6) x m: corners, then midside nodes of edges 01, 12, 20
};

}  // namespace palpate::cases
