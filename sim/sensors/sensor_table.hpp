#pragma once

#include "core/math/rigid.hpp"
#include "rt/config/node.hpp"
#include "sim/camera/depth_noise.hpp"
#include "sim/sensors/gear_friction.hpp"

namespace palpate::sensors {

/// Sampling and arrival of samples.
struct Timing {
  double rate = 0;         // Hz
  double delay = 0;        // s
  double jitter = 0;       // s, scale of a half-normal additional delay
  double drop_out = 0;     // probability that a sample is lost
  double stamp_delay = 0;  // s, from sampling to the time stamp that the message carries
};

/// Errors of one kind of signal, the same for each of its axes, in the signal's unit.
struct Faults {
  double step = 0;   // quantisation; 0: none
  double noise = 0;  // standard deviation of a sample
  double drift = 0;  // standard deviation of a random walk after 1 s
  double hysteresis =
      0;  // half the distance by which the true value must reverse before the reading follows
};

/// Errors of a force-torque sensor in addition to payload and noise.
struct ForceTorqueDisturbance {
  /// Cables along the sensor: springs from the hand to its initial pose, N/m at the origin of S and
  /// N m/rad.
  double cable_stiffness = 0, cable_torsion = 0;
  /// Temperature: final offset of the reading after switching on, N, N m, in S.
  math::Vector6d warm_up = math::Vector6d::Zero();
  double warm_up_time = 600;  // s, time constant
};

/// The skin of a BioTac (sim/sensors/biotac_skin.hpp).
struct SkinTable {
  double foundation = 3e7;       // N/m^3: pressure per depth
  double spread = 1.5e-3;        // m: spread of a point load by the skin
  double shear_stiffness = 1e3;  // N/m
  double shear_reach = 10e-3;    // m around a contact that shifts with it
  double bulge = 1;              // fraction of the displaced fluid that stays below the pad
  double friction = 0;           // m: hysteresis of a dent behind its load
  // Delayed fractions of a dent and their time constants, s.
  double fast_share = 0, fast_time = 0.1;
  double slow_share = 0, slow_time = 3;
};

/// Parameters of every BioTac; signals in counts.
struct BiotacTable {
  Timing timing;
  SkinTable skin;
  double pressure_area = 1.8e-4;  // m^2: pressing force per fluid pressure
  double polarity = 1;  // 1: electrodes rise under pressure, -1: they fall; both kinds exist
  Faults electrode, pressure, vibration, temperature;
  double warm_up = 300;  // s, time constant after switching on
  double warm_up_electrode = 0, warm_up_pressure = 0, warm_up_temperature = 0;  // counts in all
};

/// Parameters of every fingertip that reports place, normal and force.
struct FingertipTable {
  Timing timing;
  Faults place, force;  // m, N
};

/// sensors.yaml as a struct, with the changes made by a scene.
struct SensorTable {
  struct {
    Timing timing;
    Faults force, torque;                          // N, N m
    math::Vector6d bias = math::Vector6d::Zero();  // N, N m, in S
    ForceTorqueDisturbance disturbance;
    /// R_LS of the sensor as mounted, L its link of the URDF; readings, bias and warm-up are in S.
    Eigen::Matrix3d mounting = Eigen::Matrix3d::Identity();
  } force_torque;
  struct {
    Timing timing;
    Faults acceleration, angular_velocity;                   // m/s^2, rad/s
    math::Vector6d bias = math::Vector6d::Zero();            // m/s^2, rad/s, in I
    Eigen::Matrix3d mounting = Eigen::Matrix3d::Identity();  // R_LI, as above
  } imu;
  struct {
    Timing timing;
    Faults position, velocity, torque;  // rad, rad/s, N m
    GearFriction friction;              // in the joint torques
  } robot_state;
  struct {
    Timing timing;
    Faults fingertip;  // m
  } hand_state;
  BiotacTable biotac;
  FingertipTable fingertip;
  struct {
    Timing timing;
    camera::DepthNoiseOptions noise;
    math::Pose calibration_error = math::Pose::Identity();  // as in ShapeCameraOptions
  } camera;
  /// Error of the arm's kinematics at the grasp: the reported flange pose is X_WE X_EG error
  /// inverse(X_EG).
  math::Pose kinematics_error = math::Pose::Identity();
};

/// The normative table, overridden by the entries of `scene` (a scene's node "sensors"). Throws
/// config::Error.
SensorTable read_sensors(const config::Node& scene);

}  // namespace palpate::sensors
