#pragma once

#include <string>
#include <vector>

#include "core/math/rigid.hpp"

namespace palpate::sensing {

/// Rigid load behind a force-torque sensor, and what the sensor reads without any load.
struct PayloadParameters {
  double mass = 0;                                         // kg
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();  // mass * p_S_com, kg m
  math::Vector6d inertia = math::Vector6d::Zero();         // xx, xy, xz, yy, yz, zz about S, kg m^2
  math::Wrench bias;                                       // added by the sensor, in S

  /// p_S_com, m; zero without mass.
  Eigen::Vector3d center_of_mass() const;
};

/// Inertia about S, in the order of PayloadParameters, of a load whose mass is all in its centre of
/// mass: the least that a rigid body has, where its own is not known.
math::Vector6d point_inertia(double mass, const Eigen::Vector3d& first_moment) noexcept;

/// Motion of frame S as the load feels it, all in S.
struct LoadMotion {
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();        // a - g of the origin, m/s^2
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      // rad/s
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // rad/s^2
};

/// Motion of a sensor at rest: gravity only.
LoadMotion motion_at_rest(const Eigen::Matrix3d& R_WS, const Eigen::Vector3d& gravity_W) noexcept;

/// Motion from the origin's acceleration and the frame's angular velocity and acceleration, in W.
LoadMotion motion_from_world(const Eigen::Matrix3d& R_WS, const Eigen::Vector3d& acceleration_W,
                             const Eigen::Vector3d& angular_velocity_W,
                             const Eigen::Vector3d& angular_acceleration_W,
                             const Eigen::Vector3d& gravity_W) noexcept;

/// What the sensor reads, in S at its origin: the wrench that it exerts on the load, which obeys
/// Newton and Euler, F = m (a - g) + alpha x mc + omega x (omega x mc),
/// T = mc x (a - g) + I alpha + omega x I omega, plus the bias (Kubus, Kroeger and Wahl 2007).
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

/// A reading at rest. `time` (any unit) matters only where the bias drifts.
struct StaticPose {
  Eigen::Matrix3d R_WS = Eigen::Matrix3d::Identity();
  math::Wrench F_S;
  double time = 0;
};

/// A reading in motion.
struct MotionSample {
  LoadMotion motion;
  math::Wrench F_S;
  double time = 0;
};

struct IdentificationOptions {
  /// Down-weights outlying readings (Huber, 1.345 robust standard deviations).
  bool robust = false;
  /// Lets the bias change in proportion to time, as that of a sensor that warms up does.
  bool bias_drifts = false;
  /// Combinations of parameters that the data excite less than the best one by more than this
  /// factor (unit columns) are not told apart: they are left at the smallest value and named.
  double condition_limit = 1e4;
};

struct PayloadFit {
  PayloadParameters parameters;
  PayloadVector deviation = PayloadVector::Zero();  // standard; readings taken as independent
  math::Wrench bias_drift;  // per unit of time; parameters.bias is that at time 0
  math::Vector6d residual_rms = math::Vector6d::Zero();  // per axis, N and N m
  double force_rms = 0;                                  // N, of the norm of the residual force
  double torque_rms = 0;                                 // N m
  double condition = 0;                                  // of the regressor with unit columns
  int sample_count = 0;
  std::vector<std::string> untold;  // parameters in a combination that the data cannot tell
};

/// Mass, first moment and bias by least squares; the inertia stays zero. Throws
/// std::invalid_argument for fewer than four poses or numbers that are not finite.
PayloadFit identify_static(const std::vector<StaticPose>& poses, const Eigen::Vector3d& gravity_W,
                           const IdentificationOptions& options = {});

/// Direction of gravity in W, of unit length, from readings at rest: for an arm on a wall, or a
/// base that is not level. Readings alone cannot tell gravity from its opposite under a sensor of
/// the other polarity: they are taken as what the sensor exerts on the load. Throws as
/// identify_static, and where the poses do not tell the load's weight from the bias.
Eigen::Vector3d estimate_gravity_direction(const std::vector<StaticPose>& poses);

/// All ten inertial parameters and the bias. Throws as identify_static.
PayloadFit identify_motion(const std::vector<MotionSample>& samples,
                           const IdentificationOptions& options = {});

}  // namespace palpate::sensing
