#pragma once

#include <Eigen/Core>

namespace palpate::elasticity {

/// How far each node has turned since a snapshot, as rotation matrices W. Around a factor L of that
/// time, W L^-T L^-1 W^T solves with the tangent of now as long as elements have turned but not
/// much deformed (stiffness warping; Hecht et al. 2012 for factors).
class NodeWarp {
 public:
  explicit NodeWarp(int nodes);

  /// Rotations `now` and at the snapshot, unit quaternions w x y z by column; columns beyond the
  /// warp's nodes are not used.
  void update(const Eigen::Matrix4Xf& now, const Eigen::Matrix4Xf& snapshot) noexcept;

  int size() const noexcept { return nodes_; }
  Eigen::Matrix3f matrix(int node) const noexcept {
    return Eigen::Map<const Eigen::Matrix3f>(matrices_.data() + 9 * node);
  }

  /// v <- W v and v <- W^T v, three floats a node.
  void turn(Eigen::VectorXf& v) const noexcept;
  void turn_back(Eigen::VectorXf& v) const noexcept;

  /// Largest angle in rad by which a node has turned.
  double largest() const noexcept { return largest_; }

 private:
  int nodes_;
  Eigen::VectorXf matrices_;  // 9 a node
  double largest_ = 0;
};

}  // namespace palpate::elasticity
