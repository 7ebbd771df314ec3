#pragma once

#include <Eigen/Core>

namespace palpate::elasticity {

/// Rotation of each node since a snapshot, as rotation matrices W. With a factor L computed at the
/// snapshot, W L^-T L^-1 W^T solves approximately with the present tangent as long as elements have
/// rotated but not deformed much (stiffness warping; Hecht et al. 2012 for factors).
class NodeWarp {
 public:
  explicit NodeWarp(int nodes);

  /// `now`: present rotations, `snapshot`: those at the snapshot; unit quaternions w x y z by
  /// column; columns beyond the size of the warp are ignored.
  void update(const Eigen::Matrix4Xf& now, const Eigen::Matrix4Xf& snapshot) noexcept;

  int size() const noexcept { return nodes_; }
  Eigen::Matrix3f matrix(int node) const noexcept {
    return Eigen::Map<const Eigen::Matrix3f>(matrices_.data() + 9 * node);
  }

  /// v <- W v and v <- W^T v, three floats per node.
  void turn(Eigen::VectorXf& v) const noexcept;
  void turn_back(Eigen::VectorXf& v) const noexcept;

  /// Largest rotation angle of a node, rad.
  double largest() const noexcept { return largest_; }

 private:
  int nodes_;
  Eigen::VectorXf matrices_;  // 9 per node
  double largest_ = 0;
};

}  // namespace palpate::elasticity
