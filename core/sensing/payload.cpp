#include "core/sensing/payload.hpp"

namespace palpate::sensing {

Eigen::Vector3d PayloadParameters::center_of_mass() const {
  if (mass <= 0) return Eigen::Vector3d::Zero();
  return first_moment / mass;
}

math::Vector6d point_inertia(double mass, const Eigen::Vector3d& first_moment) noexcept {
  if (!(mass > 0)) return math::Vector6d::Zero();
  const Eigen::Matrix3d inertia = (first_moment.squaredNorm() * Eigen::Matrix3d::Identity() -
                                   first_moment * first_moment.transpose()) /
                                  mass;
  math::Vector6d packed;
  packed << inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1), inertia(1, 2),
      inertia(2, 2);
  return packed;
}

LoadMotion motion_at_rest(const Eigen::Matrix3d& R_WS, const Eigen::Vector3d& gravity_W) noexcept {
  LoadMotion motion;
  motion.specific_force.noalias() = -(R_WS.transpose() * gravity_W);
  return motion;
}

math::Wrench load_wrench(const PayloadParameters& payload, const LoadMotion& motion) noexcept {
  const Eigen::Vector3d& f = motion.specific_force;
  const Eigen::Vector3d& omega = motion.angular_velocity;
  const Eigen::Vector3d& alpha = motion.angular_acceleration;
  const Eigen::Vector3d& mc = payload.first_moment;
  const math::Vector6d& i = payload.inertia;
  Eigen::Matrix3d inertia;
  inertia << i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5];
  const Eigen::Vector3d angular_momentum = inertia * omega;

  math::Wrench wrench;
  wrench.force = payload.mass * f + alpha.cross(mc) + omega.cross(omega.cross(mc));
  wrench.torque = mc.cross(f) + inertia * alpha + omega.cross(angular_momentum);
  wrench.force += payload.bias.force;
  wrench.torque += payload.bias.torque;
  return wrench;
}

namespace {

/// Matrix with inertia_columns(v) * (xx, xy, xz, yy, yz, zz) = inertia * v.
Eigen::Matrix<double, 3, 6> inertia_columns(const Eigen::Vector3d& v) noexcept {
  Eigen::Matrix<double, 3, 6> m;
  m << v.x(), v.y(), v.z(), 0, 0, 0,  //
      0, v.x(), 0, v.y(), v.z(), 0,   //
      0, 0, v.x(), 0, v.y(), v.z();
  return m;
}

}  // namespace

PayloadRegressor load_regressor(const LoadMotion& motion) noexcept {
  const Eigen::Matrix3d omega = math::cross_matrix(motion.angular_velocity);
  PayloadRegressor regressor = PayloadRegressor::Zero();
  regressor.block<3, 1>(0, 0) = motion.specific_force;
  regressor.block<3, 3>(0, 1) = math::cross_matrix(motion.angular_acceleration) + omega * omega;
  regressor.block<3, 3>(3, 1) = -math::cross_matrix(motion.specific_force);
  regressor.block<3, 6>(3, 4) = inertia_columns(motion.angular_acceleration) +
                                omega * inertia_columns(motion.angular_velocity);
  regressor.block<6, 6>(0, 10).setIdentity();
  return regressor;
}

PayloadVector to_vector(const PayloadParameters& payload) noexcept {
  PayloadVector v;
  v << payload.mass, payload.first_moment, payload.inertia, payload.bias.force, payload.bias.torque;
  return v;
}

PayloadParameters payload_from_vector(const PayloadVector& v) noexcept {
  PayloadParameters payload;
  payload.mass = v[0];
  payload.first_moment = v.segment<3>(1);
  payload.inertia = v.segment<6>(4);
  payload.bias = {v.segment<3>(10), v.segment<3>(13)};
  return payload;
}

const char* payload_parameter_name(int index) noexcept {
  static constexpr const char* kNames[kPayloadParameterCount] = {
      "mass",       "mass*com_x", "mass*com_y", "mass*com_z", "inertia_xx", "inertia_xy",
      "inertia_xz", "inertia_yy", "inertia_yz", "inertia_zz", "bias_fx",    "bias_fy",
      "bias_fz",    "bias_tx",    "bias_ty",    "bias_tz"};
  return index >= 0 && index < kPayloadParameterCount ? kNames[index] : "";
}

}  // namespace palpate::sensing
