#pragma once

#include <memory>

#include "core/elasticity/element_set.hpp"
#include "tools/export/element_gradients.hpp"

namespace palpate::exporting {

/// palpated publishes the corners of its quadratic tetrahedra alone. Their midside nodes are found
/// again as what its co-rotational law makes of them: at rest between corners that are held, under
/// no load of their own. Starts each time from the last shape; one thread uses it at a time.
class MidsideNodes {
 public:
  /// Throws std::runtime_error where an element has no volume.
  explicit MidsideNodes(const log::MeshMessage& corners);

  /// The quadratic mesh: its first nodes are the corners.
  const log::MeshMessage& mesh() const { return mesh_; }
  const ElementGradients& gradients() const { return *gradients_; }

  /// All nodes, 3 x n, for the corners' positions. Stiffness itself plays no role, only Poisson's
  /// ratio does. Where there is no equilibrium nearby (elements inside out) the nodes are left
  /// where the last Newton step brought them, or halfway where even that is no number.
  Eigen::Matrix3Xd at(const Eigen::Matrix3Xd& corners, double poisson_ratio);

 private:
  Eigen::VectorXd out_of_balance(const Eigen::Matrix3Xd& x, double poisson_ratio) const;
  Eigen::Matrix3Xd halfway(const Eigen::Matrix3Xd& corners) const;

  log::MeshMessage mesh_;
  std::unique_ptr<ElementGradients> gradients_;
  std::vector<std::pair<int, int>> ends_;  // corners of each midside node
  std::vector<int> unknown_;               // by node: place among the unknowns, or -1
  int unknown_count_ = 0;
  double poisson_ratio_ = -2;  // of elements_
  std::unique_ptr<elasticity::ElementSet> elements_;
  Eigen::Matrix3Xd bow_;  // of the last shape: midside nodes from halfway, in the axes of O
};

}  // namespace palpate::exporting
