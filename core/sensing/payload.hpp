#pragma once

#include <string>
#include <vector>

#include "core/math/rigid.hpp"

namespace palpate::sensing {

/// Rigid load of a force-torque sensor, and the sensor's reading without load.
struct PayloadParameters {
  double mass = 0;                                         // kg
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();  // mass * p_S_com, kg m
  math::Vector6d inertia = math::Vector6d::Zero();         // xx, xy, xz, yy, yz, zz about S, kg m^2
  math::Wrench bias;                                       // sensor bias, in S

  /// p_S_com, m; zero if the mass is zero.
  Eigen::Vector3d center_of_mass() const;
};

/// Inertia about S, in the order of PayloadParameters, of a point mass at the centre of mass: lower
/// bound for a rigid body whose inertia is unknown.
math::Vector6d point_inertia(double mass, const Eigen::Vector3d& first_moment) noexcept;

/// Motion of frame S as experienced by the load, all in S.
struct LoadMotion {
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();        // a - g at the origin, m/s^2
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      // rad/s
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // rad/s^2
};

/// Motion of a sensor at rest: gravity only.
LoadMotion motion_at_rest(const Eigen::Matrix3d& R_WS, const Eigen::Vector3d& gravity_W) noexcept;

/// Reading of the sensor, in S at its origin: wrench exerted on the load by Newton-Euler, F = m (a
/// - g) + alpha x mc + omega x (omega x mc), T = mc x (a - g) + I alpha + omega x I omega, plus the
/// bias (Kubus, Kroeger and Wahl 2007).
math::Wrench load_wrench(const PayloadParameters& payload, const LoadMotion& motion) noexcept;

/// Columns: mass, first moment (3), inertia (6), bias force (3), bias torque (3).
inline constexpr int kPayloadParameterCount = 16;
using PayloadVector = Eigen::Matrix<double, kPayloadParameterCount, 1>;
using PayloadRegressor = Eigen::Matrix<double, 6, kPayloadParameterCount>;

/// load_wrench is linear in the parameters: wrench = load_regressor(motion) * to_vector(payload).
PayloadRegressor load_regressor(const LoadMotion& motion) noexcept;
PayloadVector to_vector(const PayloadParameters& payload) noexcept;
PayloadParameters payload_from_vector(const PayloadVector& vector) noexcept;
/// Names of the entries of PayloadVector, for messages.
const char* payload_parameter_name(int index) noexcept;

/// Reading in motion.
struct MotionSample {
  LoadMotion motion;
  math::Wrench F_S;
};

struct PayloadFit {
  PayloadParameters parameters;
  PayloadVector deviation = PayloadVector::Zero();  // standard deviations, for independent readings
  math::Vector6d residual_rms = math::Vector6d::Zero();  // per axis, N and N m
  double force_rms = 0;                                  // N, RMS of the norm of the residual force
  double torque_rms = 0;                                 // N m
  /// Condition number of the regressor with unit columns.
  double condition = 0;
  int sample_count = 0;
  std::vector<std::string>
      unidentified;  // parameters in combinations that the data do not identify
};

/// Identifies all ten inertial parameters and the bias by least squares. Combinations of parameters
/// that the readings hardly excite are set to the minimum-norm value and reported. Throws
/// std::invalid_argument for fewer than four readings or non-finite numbers.
PayloadFit identify_payload(const std::vector<MotionSample>& samples);

}  // namespace palpate::sensing
