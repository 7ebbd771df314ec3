#pragma once

#include <array>
#include <vector>

#include "core/elasticity/element.hpp"
#include "core/factor/block_matrix.hpp"
#include "core/solid/solid_material.hpp"

namespace palpate::solid {

/// Ten-node tetrahedra of one hyperelastic solid (SolidCoefficients), for fitting. Constant after
/// construction.
class SolidElements {
 public:
  /// Throws std::invalid_argument unless `mesh` is quadratic with elements of positive volume.
  explicit SolidElements(const mesh::ElementMesh& mesh);

  const mesh::ElementMesh& mesh() const { return mesh_; }

  /// Energy, J, at positions x, and `forces` = dEnergy/dx, N, both 3 x n. Returns infinity, with
  /// undefined forces, if a point is inverted.
  double forces(const Eigen::Matrix3Xd& x, const SolidCoefficients& c,
                Eigen::Matrix3Xd& forces) const;

  /// Adds `factor` times the second derivative of the energy. No point may be inverted at x.
  void add_tangent(const Eigen::Matrix3Xd& x, const SolidCoefficients& c, double factor,
                   factor::BlockMatrix& tangent) const;

 private:
  using Element = elasticity::Tetrahedron<10>;
  using Nodes = Element::Gradients;
  struct Shape {
    std::array<Nodes, Element::kPoints> gradients;  // 1/m
    double weight = 0;                              // m^3, volume of a point
  };

  Nodes gather(int element, const Eigen::Matrix3Xd& x) const;

  mesh::ElementMesh mesh_;
  std::vector<Shape> shapes_;
};

}  // namespace palpate::solid
