#pragma once

#include <Eigen/Core>
#include <optional>

#include "tools/export/element_gradients.hpp"

namespace palpate::exporting {

using Tensors = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // xx yy zz xy xz yz

/// Fields derived from the positions of a shape. By node, 3 x n, and by element.
struct ShapeFields {
  Eigen::Matrix3Xd displacement;      // m, from rest
  Tensors strain;                     // Green-Lagrange, mean of the element, in the axes at rest
  Eigen::VectorXd equivalent_strain;  // sqrt(2/3 |dev E|^2)
  // If the stiffness is known, otherwise empty:
  Tensors stress;             // Cauchy, Pa, mean of the element
  Eigen::VectorXd von_mises;  // Pa
  Eigen::Matrix3Xd force;     // N, external force on each node in equilibrium
};

/// Evaluates the fields of one mesh. Stress and forces of an estimate are those that palpated
/// itself computes, except for the effect of the elements' weight; former logs contain the corner
/// nodes of quadratic elements only, which are taken as linear ones.
class ShapeEvaluator {
 public:
  /// Throws as ElementGradients.
  ShapeEvaluator(const log::MeshMessage& mesh, Law law);

  ShapeFields at(const Eigen::Matrix3Xd& positions,
                 const std::optional<Stiffness>& stiffness) const;

  /// An element field at the nodes: the mean over the adjacent elements, weighted by their volume.
  Eigen::VectorXd at_nodes(const Eigen::VectorXd& by_element) const;

  const log::MeshMessage& mesh() const { return mesh_; }

 private:
  void add_strain(const Eigen::Matrix3Xd& x, ShapeFields& fields) const;
  void add_stress(const Eigen::Matrix3Xd& x, const Stiffness& stiffness, ShapeFields& fields) const;

  Law law_;
  log::MeshMessage mesh_;
  ElementGradients gradients_;
  Eigen::VectorXd element_volume_;
  Eigen::VectorXd node_volume_;  // of the elements around each
};

}  // namespace palpate::exporting
