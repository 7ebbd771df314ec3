#include "core/math/rigid.hpp"

#include <cmath>

namespace palpate::math {

Pose make_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation;
  pose.translation() = translation;
  return pose;
}

Eigen::Matrix3d exp_rotation(const Eigen::Vector3d& omega) {
  // I + a [w] + b [w]^2 with a = sin t / t and b = (1 - cos t) / t^2, b in terms of the half angle
  // to avoid cancellation.
  const double t = omega.norm();
  const auto sinc = [](double x) { return x < 1e-4 ? 1 - x * x / 6 : std::sin(x) / x; };
  const double half = sinc(0.5 * t);
  const Eigen::Matrix3d w = cross_matrix(omega);
  return Eigen::Matrix3d::Identity() + sinc(t) * w + 0.5 * half * half * w * w;
}

Eigen::Vector3d log_rotation(const Eigen::Matrix3d& rotation) {
  // via the quaternion, which is well conditioned at every angle, including pi
  const Eigen::Quaterniond q = Eigen::Quaterniond(rotation).normalized();
  const double s = q.vec().norm();
  const double sign = q.w() < 0 ? -1 : 1;
  if (s < 1e-12) return sign * 2 * q.vec();
  return (sign * 2 * std::atan2(s, std::abs(q.w())) / s) * q.vec();
}

Eigen::Matrix3d inverse_left_jacobian(const Eigen::Vector3d& omega) {
  // I - [w]/2 + c [w]^2 with c = (1 - (t/2) cot(t/2)) / t^2.
  const double t2 = omega.squaredNorm();
  const double half = 0.5 * std::sqrt(t2);
  const double c =
      t2 < 1e-4 ? 1.0 / 12 + t2 / 720 : (1 - half * std::cos(half) / std::sin(half)) / t2;
  const Eigen::Matrix3d w = cross_matrix(omega);
  return Eigen::Matrix3d::Identity() - 0.5 * w + c * w * w;
}

Wrench transform(const Pose& X_AB, const Wrench& F_B) {
  const Eigen::Vector3d force = X_AB.linear() * F_B.force;
  return {force, X_AB.linear() * F_B.torque + X_AB.translation().cross(force)};
}

Wrench move_reference(const Wrench& F, const Eigen::Vector3d& offset) {
  return {F.force, F.torque - offset.cross(F.force)};
}

Twist move_reference(const Twist& V, const Eigen::Vector3d& offset) {
  return {V.linear + V.angular.cross(offset), V.angular};
}

bool is_unit_quaternion(const double* wxyz) noexcept {
  double squared = 0;
  for (int i = 0; i < 4; ++i) squared += wxyz[i] * wxyz[i];
  // false for NaN and infinite components
  return std::abs(squared - 1) <= 1e-3;
}

Eigen::Matrix3d rotation_from_wxyz(const double* wxyz) noexcept {
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized().toRotationMatrix();
}

void wxyz_from_rotation(const Eigen::Matrix3d& rotation, double* wxyz) noexcept {
  const Eigen::Quaterniond q = Eigen::Quaterniond(rotation).normalized();
  const double sign = q.w() < 0 ? -1 : 1;
  wxyz[0] = sign * q.w();
  wxyz[1] = sign * q.x();
  wxyz[2] = sign * q.y();
  wxyz[3] = sign * q.z();
}

}  // namespace palpate::math
