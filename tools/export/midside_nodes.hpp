#pragma once

#include <memory>

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

}  // namespace palpate::exporting
