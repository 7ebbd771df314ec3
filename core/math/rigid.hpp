#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate::math {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Rigid transform X_AB: the pose of frame B in frame A; p_A = X_AB * p_B.
using Pose = Eigen::Isometry3d;

/// Velocity of a frame: linear velocity of its origin (m/s) first, angular velocity (rad/s) second.
struct Twist {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();

  Vector6d vector() const { return (Vector6d() << linear, angular).finished(); }
  static Twist from(const Vector6d& v) { return {v.head<3>(), v.tail<3>()}; }
};

/// Force (N) and torque (N m) about a stated point, acting on the object unless stated otherwise.
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();

  Vector6d vector() const { return (Vector6d() << force, torque).finished(); }
  static Wrench from(const Vector6d& v) { return {v.head<3>(), v.tail<3>()}; }
};

/// Skew-symmetric matrix with cross_matrix(a) * b = a x b.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

/// Rotation of both the linear and the angular part of a twist or wrench.
inline Matrix6d both_halves(const Eigen::Matrix3d& R) noexcept {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R;
  return turn;
}

/// Pose from rotation and translation.
Pose make_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation);

/// Rotation by |omega| radians about omega (Rodrigues), accurate also for small angles.
Eigen::Matrix3d exp_rotation(const Eigen::Vector3d& omega);

/// Inverse of exp_rotation, angle in [0, pi].
Eigen::Vector3d log_rotation(const Eigen::Matrix3d& rotation);

/// Inverse of the left Jacobian of SO(3) at omega: d log(exp(eps) R) / d eps with omega = log R.
Eigen::Matrix3d inverse_left_jacobian(const Eigen::Vector3d& omega);

/// Transforms a wrench about the origin of B, in B, to the same wrench about the origin of A, in A.
Wrench transform(const Pose& X_AB, const Wrench& F_B);

/// Moves the reference point of a wrench by `offset` (new point minus old point), same axes.
Wrench move_reference(const Wrench& F, const Eigen::Vector3d& offset);

/// Twist of a frame rigidly attached to another, whose origin is at `offset` from that of the
/// first; same axes.
Twist move_reference(const Twist& V, const Eigen::Vector3d& offset);

/// True if |q|^2 is within 1e-3 of 1 and every component is finite. Order w, x, y, z.
bool is_unit_quaternion(const double* wxyz) noexcept;

/// Rotation of a quaternion w, x, y, z that satisfies is_unit_quaternion(); it is normalised first.
Eigen::Matrix3d rotation_from_wxyz(const double* wxyz) noexcept;

/// Writes w, x, y, z with w >= 0.
void wxyz_from_rotation(const Eigen::Matrix3d& rotation, double* wxyz) noexcept;

}  // namespace palpate::math
