#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "core/elasticity/element_set.hpp"
#include "tools/export/element_gradients.hpp"

namespace palpate::exporting {

/// palpated publishes only the corners of its quadratic tetrahedra. Their midside nodes are
/// recomputed from its co-rotational law: in equilibrium between fixed corners, without load of
/// their own. Each solution starts from the last shape; to be used by one thread at a time.
class MidsideNodes {
 public:
  /// Throws std::runtime_error if an element has no volume.
  explicit MidsideNodes(const log::MeshMessage& corners);

  /// The quadratic mesh: its first nodes are the corners.
  const log::MeshMessage& mesh() const { return mesh_; }
  const ElementGradients& gradients() const { return *gradients_; }

  /// All nodes, 3 x n, for the corners' positions. Only Poisson's ratio matters, not the stiffness.
  /// If there is no equilibrium nearby (inverted elements) the nodes stay where the last Newton
  /// step put them, or halfway between the corners if that is not finite.
  Eigen::Matrix3Xd at(const Eigen::Matrix3Xd& corners, double poisson_ratio);

 private:
  Eigen::VectorXd out_of_balance(const Eigen::Matrix3Xd& x, double poisson_ratio) const;
  Eigen::Matrix3Xd halfway(const Eigen::Matrix3Xd& corners) const;

  log::MeshMessage mesh_;
  std::unique_ptr<ElementGradients> gradients_;
  std::vector<std::pair<int, int>> ends_;  // corners of each midside node
  std::vector<int> unknown_;               // by node: index among the unknowns, or -1
  int unknown_count_ = 0;
  double poisson_ratio_ = -2;  // of elements_
  std::unique_ptr<elasticity::ElementSet> elements_;
  Eigen::Matrix3Xd
      bow_;  // of the last shape: midside nodes relative to the midpoint, in the axes of O
};

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

/// Evaluates the fields of one mesh. Of quadratic tetrahedra only the corners are published; their
/// midside nodes are recomputed (MidsideNodes), so that stress and forces are those that palpated
/// itself computes, except for the effect of the elements' weight.
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

  const ElementGradients& gradients() const;

  Law law_;
  log::MeshMessage mesh_;
  std::unique_ptr<MidsideNodes> midsides_;       // of quadratic tetrahedra, or
  std::unique_ptr<ElementGradients> gradients_;  // of others
  Eigen::VectorXd element_volume_;
  Eigen::VectorXd node_volume_;  // of the elements around each
};

}  // namespace palpate::exporting
