#pragma once

#include <vector>

#include "core/elasticity/body.hpp"
#include "core/elasticity/element.hpp"

namespace palpate::elasticity {

/// Matrices of the elements of a body, one element at a time, in mesh numbering. Constant after
/// construction, therefore shareable between threads.
class ElementSet {
 public:
  /// Throws std::invalid_argument if an element has no positive volume.
  explicit ElementSet(const Body& body);

  int element_count() const { return static_cast<int>(mesh_.element_count()); }
  int nodes_per_element() const { return mesh_.nodes_per_element(); }
  const mesh::ElementMesh& mesh() const { return mesh_; }
  const ElementMaterials& materials() const { return materials_; }
  double volume() const { return volume_; }  // m^3, at rest
  Eigen::Matrix<double, 3, 4> rest_corners(int element) const;

  /// Symmetric tangent of one element at positions x (3 x n), 3 N x 3 N, with the linear law, plus
  /// `viscous` times its warped stiffness.
  void stiffness(int element, const Eigen::Matrix3Xd& x, Tangent kind, double viscous,
                 Eigen::MatrixXd& K) const;

  /// Consistent mass of one element, N x N, kg (identical for all axes).
  void mass(int element, Eigen::MatrixXd& M) const;

  /// Integral of each node's shape function times the density, kg; multiplied by g it is the body
  /// force.
  const Eigen::VectorXd& nodal_mass() const { return nodal_mass_; }

 private:
  template <int kNodes>
  void element_stiffness(int element, const Eigen::Matrix3Xd& x, Tangent kind, double viscous,
                         Eigen::MatrixXd& K) const;

  mesh::ElementMesh mesh_;
  ElementMaterials materials_;
  std::vector<double> density_;  // by element, kg/m^3
  double volume_ = 0;
  Eigen::VectorXd nodal_mass_;
};

}  // namespace palpate::elasticity
