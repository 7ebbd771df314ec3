#pragma once

#include <array>
#include <optional>

#include "core/math/rigid.hpp"

namespace palpate::frames {

/// Constant transforms of one arm in its workcell, and what follows from them and the pose X_WE of
/// its flange. Frames: W base of that arm, E flange, S force-torque sensor, I IMU, G grasp, O
/// object (the rest frame of its mesh), T fingertip. Wrenches act on the object; m, rad, N, N m.
/// Nothing allocates.
struct ArmFrames {
  math::Pose X_WO = math::Pose::Identity();  // object's rest frame in the robot base
  math::Pose X_ES = math::Pose::Identity();  // pose of the force-torque sensor in the flange
  math::Pose X_EI = math::Pose::Identity();  // pose of the IMU in the flange
  math::Pose X_EG = math::Pose::Identity();  // pose of the grasp in the flange
  Eigen::Vector3d gravity_W{0, 0, -9.81};    // m/s^2
  /// Poses of fingertips that are fixed in O, for a workcell without hand state.
  std::array<std::optional<math::Pose>, 5> X_OT;

  math::Pose X_OE(const math::Pose& X_WE) const noexcept { return X_WO.inverse() * X_WE; }
  math::Pose X_OG(const math::Pose& X_WE) const noexcept { return X_OE(X_WE) * X_EG; }

  /// Wrench about the origin of G, in O, from the same wrench about the origin of S, in S. `R_OG`:
  /// rotation of X_OG().
  math::Wrench wrench_in_object(const math::Wrench& F_S,
                                const Eigen::Matrix3d& R_OG) const noexcept;

  /// Velocity of the flange in W from that of the grasp in O. `R_WE`: rotation of X_WE.
  math::Twist flange_twist(const math::Twist& V_O_G, const Eigen::Matrix3d& R_WE) const noexcept;
  /// Velocity of the grasp in O from that of the flange in W; inverse of flange_twist().
  math::Twist grasp_twist(const math::Twist& V_W_E, const Eigen::Matrix3d& R_WE) const noexcept;
};

/// The same wrench in the axes of A instead of B, about the same point.
math::Wrench rotated(const Eigen::Matrix3d& R_AB, const math::Wrench& F_B) noexcept;

/// Whether two poses differ by less than `distance`, m, and `angle`, rad. The angle is measured as
/// |R - R'| / sqrt(2) (Frobenius norm), which equals it where it is small.
bool are_near(const math::Pose& a, const math::Pose& b, double distance, double angle) noexcept;

}  // namespace palpate::frames
