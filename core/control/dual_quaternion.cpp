#include "core/control/dual_quaternion.hpp"

#include <cmath>
#include <cstring>
#include <stdexcept>

namespace palpate::control {
namespace {

Eigen::Quaterniond rotation_of(const Eigen::VectorXd& pose) {
  return Eigen::Quaterniond(pose[3], pose[4], pose[5], pose[6]).normalized();
}

Eigen::Quaterniond pure(const Eigen::Vector3d& v) {
  return Eigen::Quaterniond(0, v.x(), v.y(), v.z());
}

}  // namespace

Screw screw_between(const Eigen::VectorXd& current, const Eigen::VectorXd& desired) noexcept {
  const Eigen::Vector3d p_c = current.head<3>();
  const Eigen::Vector3d p_d = desired.head<3>();
  // x = q + eps p q / 2 for each pose; x_c (x) x_d* = real + eps dual.
  const Eigen::Quaterniond real = rotation_of(current) * rotation_of(desired).conjugate();
  Eigen::Vector4d dual = 0.5 * ((pure(p_c) * real).coeffs() - (real * pure(p_d)).coeffs());
  // Both signs name one displacement; w >= 0 is the short way round.
  const double sign = real.w() < 0 ? -1 : 1;
  dual *= sign;
  const double cosine = sign * real.w();
  const double sine = real.vec().norm();

  Screw screw;
  if (sine < 1e-9) {  // a translation: the line is anywhere, d l = p_c - p_d
    const Eigen::Vector3d displacement = p_c - p_d;
    screw.distance = displacement.norm();
    if (screw.distance > 0) screw.direction = displacement / screw.distance;
    return screw;
  }
  screw.angle = 2 * std::atan2(sine, cosine);
  screw.direction = sign * real.vec() / sine;
  screw.distance = -2 * dual[3] / sine;  // Eigen stores x, y, z, w
  screw.moment = (dual.head<3>() - 0.5 * screw.distance * cosine * screw.direction) / sine;
  return screw;
}

void DualQuaternion::configure_for(const shape::Feature& feature) {
  if (std::strcmp(feature.kind(), "pose") != 0) {
    throw std::invalid_argument("the law dual_quaternion steers pose features only");
  }
  TwistLaw::configure_for(feature);
}

void DualQuaternion::motion_to_target(const LawInputs& inputs, Eigen::VectorXd& motion) noexcept {
  const math::Twist error = screw_between(*inputs.value, *inputs.target).twist();
  const Eigen::Vector3d p_c = inputs.value->head<3>();
  motion.head<3>() = -(error.linear + error.angular.cross(p_c));  // at the origin of the feature
  motion.tail<3>() = -error.angular;
}

}  // namespace palpate::control
