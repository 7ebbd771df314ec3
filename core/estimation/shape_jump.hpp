#pragma once

#include <Eigen/Core>

namespace palpate::estimation {

/// Tells a shape that jumps from one that moves: some node is further from where it was in the
/// cycle before than 1 % of the object's size and 2 m/s explain. Whatever the cause, who reads the
/// shape must know. Nothing allocates after construction.
class ShapeJump {
 public:
  /// `rest`: 3 x n, m, of the shapes to come.
  explicit ShapeJump(const Eigen::Matrix3Xd& rest);
  ShapeJump() = default;

  /// What comes next is no jump, however far from the last.
  void forget() noexcept { known_ = false; }
  /// Whether `positions`, 3 x n, have jumped within `dt` s. Not finite ones have.
  bool update(const Eigen::Matrix3Xd& positions, double dt) noexcept;

 private:
  double share_of_size_ = 0;  // m
  Eigen::Matrix3Xd last_;
  bool known_ = false;
};

}  // namespace palpate::estimation
