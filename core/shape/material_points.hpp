#pragma once

#include <string>
#include <vector>

#include "core/mesh/point_locator.hpp"

namespace palpate::shape {

/// Points of the rest shape and the nodes that interpolate them.
class MaterialPoints {
 public:
  /// Throws std::invalid_argument if a point is not finite or lies more than 1 mm outside the mesh.
  MaterialPoints(const mesh::ElementMesh& mesh, std::vector<Eigen::Vector3d> rest_points);

  int count() const noexcept { return static_cast<int>(rest_points_.size()); }
  const std::vector<Eigen::Vector3d>& rest_points() const noexcept { return rest_points_; }

  /// All nodes that interpolate one of the points, sorted.
  const std::vector<int>& support() const noexcept { return support_; }

  /// Current position of `point`, from node positions, 3 x n.
  Eigen::Vector3d position(int point, const Eigen::Matrix3Xd& positions) const noexcept {
    return weights_[point].interpolate(positions);
  }

  /// d point / d position of each node of support(): one factor per node, equal for all axes.
  /// count() x |support|.
  const Eigen::MatrixXd& weights() const noexcept { return support_weights_; }

 private:
  std::vector<Eigen::Vector3d> rest_points_;
  std::vector<mesh::PointWeights> weights_;
  std::vector<int> support_;
  Eigen::MatrixXd support_weights_;
};

}  // namespace palpate::shape
