#pragma once

#include <array>

#include "core/elasticity/incremental/numbered_body.hpp"

namespace palpate::elasticity {

/// What acts on a body from outside: hands that hold its patches, gravity and nodal loads. Nodal
/// fields are in the solver's numbering, 3 x n matrices in mesh order; all quantities in O.
class BoundaryConditions {
 public:
  /// `body` must outlive this object.
  explicit BoundaryConditions(const NumberedBody& body);

  /// Sets the pose that the hand of `grasp` is to have after the next apply(). Returns whether it
  /// was not held before; it then begins at the pose given by the present `positions`.
  bool hold(int grasp, const math::Pose& X_OG, const Eigen::Matrix3Xd& positions) noexcept;
  /// Returns whether the grasp was held.
  bool release(int grasp) noexcept;
  /// Removes grasps and loads. Gravity is kept.
  void clear() noexcept;

  void set_gravity(const Eigen::Vector3d& gravity_O) noexcept { gravity_ = gravity_O; }
  const Eigen::Vector3d& gravity() const noexcept { return gravity_; }  // m/s^2
  Eigen::Matrix3Xd& loads() noexcept { return loads_; }                 // N, in addition to weight
  const Eigen::Matrix3Xd& loads() const noexcept { return loads_; }
  const factor::Held& held() const noexcept { return held_; }
  bool are_finite() const noexcept;

  /// Moves the nodes of held grasps in `x` to their hands.
  void apply(NodalField& x) noexcept;
  /// Poses X_OG of the hands at the last apply(); meaningful where held.
  const std::array<math::Pose, 2>& applied() const noexcept { return applied_; }
  void set_applied(const std::array<math::Pose, 2>& poses) noexcept { applied_ = poses; }
  /// Sets the poses of held grasps to those given by `positions`.
  void set_applied_by(const Eigen::Matrix3Xd& positions) noexcept;
  /// Motion of a held hand from rest, at the last apply().
  math::Pose motion_from_rest(int grasp) const noexcept;
  /// Motion (m, rad) of a held hand that the next apply() will make.
  math::Vector6d pending_motion(int grasp) const noexcept;

  /// Sets `forces` to loads and weight, N, at all nodes.
  void external_forces(NodalField& forces) const noexcept;
  /// Largest of `forces` at a node that is free to move, N.
  double largest_at_free_nodes(const NodalField& forces) const noexcept;
  /// Zeroes the coordinates of held nodes in `b`, three per unknown node.
  void clear_held_nodes(Eigen::VectorXf& b) const noexcept;
  /// Wrench of the hand on the object at the origin of G; `forces`: those required at the nodes.
  math::Wrench reaction(int grasp, const NodalField& forces,
                        const Eigen::Matrix3Xd& positions) const noexcept;

 private:
  const NumberedBody& body_;
  factor::Held held_{false, false};
  std::array<math::Pose, 2> target_{math::Pose::Identity(), math::Pose::Identity()};
  std::array<math::Pose, 2> applied_{math::Pose::Identity(), math::Pose::Identity()};
  Eigen::Vector3d gravity_;
  Eigen::Matrix3Xd loads_;
  NodalField weight_per_gravity_;  // kg
};

}  // namespace palpate::elasticity
