#pragma once

#include <cmath>

#include "core/math/rigid.hpp"

namespace palpate::math {

/// Screw motion: rotation by theta (rad, 0 to pi) about a line of unit direction l and moment
/// m = p x l (m, p any point of the line), and translation d (m) along it. A pure translation has
/// theta = 0 and m = 0.
struct Screw {
  double theta = 0;
  double d = 0;
  Eigen::Vector3d l = Eigen::Vector3d::UnitX();
  Eigen::Vector3d m = Eigen::Vector3d::Zero();

  /// Constant twist, about the origin and in its axes, that produces this motion in unit time:
  /// linear theta m + d l, angular theta l.
  Twist twist() const { return {theta * m + d * l, theta * l}; }
};

/// Unit dual quaternion real + eps dual, for poses (Daniilidis 1999; Ozgur and Mezouar 2016).
/// dual = 1/2 t real for a translation t.
struct DualQuaternion {
  Eigen::Quaterniond real = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond dual = Eigen::Quaterniond(0, 0, 0, 0);

  static DualQuaternion from_pose(const Pose& X) {
    const Eigen::Quaterniond r = Eigen::Quaterniond(X.linear()).normalized();
    const Eigen::Vector3d t = 0.5 * X.translation();
    return {r, Eigen::Quaterniond(0, t.x(), t.y(), t.z()) * r};
  }

  Eigen::Vector3d translation() const { return 2 * (dual * real.conjugate()).vec(); }
  Pose pose() const { return make_pose(real.toRotationMatrix(), translation()); }

  /// Inverse motion.
  DualQuaternion conjugate() const { return {real.conjugate(), dual.conjugate()}; }

  /// Screw of the motion with the smaller angle. Valid for every angle, including 0 and pi.
  Screw log() const {
    const Eigen::Vector3d t = translation();
    const double sine = real.vec().norm();
    if (sine < 1e-12) {
      const double length = t.norm();
      return {0, length, length > 0 ? Eigen::Vector3d(t / length) : Eigen::Vector3d::UnitX(),
              Eigen::Vector3d::Zero()};
    }
    const double cosine = std::abs(real.w());
    Screw screw;
    screw.theta = 2 * std::atan2(sine, cosine);
    screw.l = (real.w() < 0 ? -1 / sine : 1 / sine) * real.vec();
    screw.d = t.dot(screw.l);
    screw.m = 0.5 * (t.cross(screw.l) + cosine / sine * (t - screw.d * screw.l));
    return screw;
  }
};

/// First b, then a, as for poses: X_AC = X_AB * X_BC.
inline DualQuaternion operator*(const DualQuaternion& a, const DualQuaternion& b) {
  const Eigen::Quaterniond dual((a.real * b.dual).coeffs() + (a.dual * b.real).coeffs());
  return {a.real * b.real, dual};
}

}  // namespace palpate::math
