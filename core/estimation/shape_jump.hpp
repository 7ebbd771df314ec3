#pragma once

#include <Eigen/Core>

namespace palpate::estimation {

/// Detects discontinuities of the shape: a node has moved since the previous cycle by more than 1 %
/// of the object's size plus the distance covered at 2 m/s. Consumers of the shape need this flag
/// whatever the cause. Nothing allocates after construction.
class ShapeJump {
 public:
  /// `rest`: rest positions, 3 x n, m; later shapes have the same size.
  explicit ShapeJump(const Eigen::Matrix3Xd& rest);
  ShapeJump() = default;

  /// The next shape is not a jump, however different.
  void forget() noexcept { known_ = false; }
  /// True if `positions`, 3 x n, have jumped within `dt` s, or are not finite.
  bool update(const Eigen::Matrix3Xd& positions, double dt) noexcept;

 private:
  double share_of_size_ = 0;  // m
  Eigen::Matrix3Xd last_;
  bool known_ = false;
};

}  // namespace palpate::estimation
