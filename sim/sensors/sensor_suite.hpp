#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sim/sensors/biotac.hpp"
#include "sim/sensors/channel.hpp"
#include "sim/sensors/fingertip_sensor.hpp"

namespace palpate::sensors {

/// Each reading carries the simulated time (us) of its sampling, plus the stamp's delay.
struct ForceTorqueReading {
  std::int64_t time_us = 0;
  math::Vector6d wrench;  // N, N m: sensor on hand at the origin of S, in S
};

struct InertialReading {
  std::int64_t time_us = 0;
  math::Vector6d motion;  // specific force m/s^2, then angular velocity rad/s, in I
};

struct RobotReading {
  std::int64_t time_us = 0;
  Eigen::VectorXd q, dq, tau;  // rad, rad/s, N m
  math::Pose X_WE = math::Pose::Identity();
  math::Twist V_W_E;  // of the origin of E, in W
};

struct HandReading {
  std::int64_t time_us = 0;
  bool holding = false;
  bool slipping = false;         // while it holds
  std::vector<math::Pose> X_ET;  // fingertips
  Eigen::VectorXd q;             // rad
};

/// True values at one instant, without errors, in the links of the URDF; the suite fills in the
/// times.
struct Truth {
  ForceTorqueReading force_torque;
  InertialReading imu;
  RobotReading robot;
  HandReading hand;
  math::Pose X_WS = math::Pose::Identity();           // the force-torque sensor
  std::vector<std::vector<Touch>> touches;            // by fingertip; empty: none is sampled
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;  // of the flange, linear first
};

inline constexpr int kMostFingertips = 5;

/// All sensors of arm and hand. All randomness derives from the one seed; each sensor has its own
/// stream, so that changing one does not change the readings of another.
class SensorSuite {
 public:
  /// `X_EG`: the pose at which the kinematics error is defined.
  SensorSuite(const SensorTable& table, std::uint64_t seed, const math::Pose& X_EG,
              int joint_count);

  /// Call once per tick, with increasing time.
  void sample(std::int64_t now_us, const Truth& truth);

  /// Readings that have arrived by `now_us`, oldest first; false if there are none left.
  bool take(std::int64_t now_us, ForceTorqueReading& r) { return force_torque_.take(now_us, r); }
  bool take(std::int64_t now_us, InertialReading& r) { return imu_.take(now_us, r); }
  bool take(std::int64_t now_us, RobotReading& r) { return robot_.take(now_us, r); }
  bool take(std::int64_t now_us, HandReading& r) { return hand_.take(now_us, r); }
  bool take(std::int64_t now_us, int finger, BiotacReading& r) {
    return biotac_channels_[finger].take(now_us, r);
  }
  bool take(std::int64_t now_us, int finger, FingertipReading& r) {
    return fingertip_channels_[finger].take(now_us, r);
  }

 private:
  math::Vector6d disturbed_wrench(std::int64_t now_us, const Truth& truth);
  RobotReading measure_robot(const Truth& truth);
  HandReading measure_hand(const HandReading& truth);
  void sample_fingertips(std::int64_t now_us, const std::vector<std::vector<Touch>>& touches);

  Channel<ForceTorqueReading> force_torque_;
  Channel<InertialReading> imu_;
  Channel<RobotReading> robot_;
  Channel<HandReading> hand_;
  Eigen::Matrix3d R_LS_, R_LI_;  // mounting of force-torque sensor and inertial unit
  ForceTorqueDisturbance disturbance_;
  std::optional<math::Pose> X_WS_first_;
  Signal force_, torque_, acceleration_, angular_velocity_;
  Signal joint_position_, joint_velocity_, joint_torque_;
  FrictionTorque friction_;
  std::vector<Signal> fingertips_;
  std::vector<Channel<BiotacReading>> biotac_channels_;
  std::vector<Biotac> biotacs_;
  std::vector<Channel<FingertipReading>> fingertip_channels_;
  std::vector<FingertipSensor> fingertip_sensors_;
  std::int64_t last_us_ = 0;
  math::Pose X_EE_reported_;  // reported flange pose in the true one
};

}  // namespace palpate::sensors
