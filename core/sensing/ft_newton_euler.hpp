#pragma once

#include <Eigen/Core>

#include "core/math/filter.hpp"
#include "core/math/update_result.hpp"
#include "core/sensing/payload.hpp"
#include "core/sensing/sensor_model.hpp"

namespace palpate::sensing {

/// Offset of an accelerometer, in a frame S that moves with it: the mean over a time window of its
/// reading minus the actual change of the robot's velocity. Without the robot's velocity an offset
/// could be distinguished from acceleration only for an arm that starts at rest: in the first
/// tenths of a second of a motion the mean contains little else than its acceleration. Nothing
/// allocates.
class AccelerometerOffset {
 public:
  /// Velocity of the origin of S in W as reported by the robot.
  struct Velocity {
    double time = 0;                                     // s, of the robot's clock
    Eigen::Vector3d linear = Eigen::Vector3d::Zero();    // m/s
    Eigen::Matrix3d R_WS = Eigen::Matrix3d::Identity();  // orientation at that time
  };

  /// `memory`: s, time constant of the mean; during its first seconds a plain mean is used. 0: the
  /// offset is zero.
  explicit AccelerometerOffset(double memory) : memory_(memory) {}

  /// Adds an acceleration of the origin of S (m/s^2, in S, without gravity), measured over the last
  /// `step` s.
  void follow(const Eigen::Vector3d& acceleration_S, double step,
              const Velocity& velocity) noexcept;
  /// Marks a gap in the accelerations: the next velocity has no predecessor.
  void pause() noexcept { has_velocity_ = false; }
  void reset() noexcept;

  const Eigen::Vector3d& value_S() const noexcept { return value_S_; }

 private:
  double memory_;
  Eigen::Vector3d value_S_ = Eigen::Vector3d::Zero();
  double age_ = 0;  // s of readings in the mean
  Velocity before_;
  bool has_velocity_ = false;
};

/// Contact wrench at the wrist = reading minus load of a rigid payload (load_wrench): gravity from
/// the robot's orientation and, while an IMU delivers data, inertial forces from it. The remainder
/// of the wrench of the sensor on the hand equals the wrench of the hand on the object.
class FtNewtonEuler : public TaredModel<6, SensorState::Offset::kWithoutPayload> {
 public:
  struct Options {
    PayloadParameters payload;
    Eigen::Vector3d gravity_W{0, 0, -9.81};    // m/s^2
    math::Pose X_ES = math::Pose::Identity();  // pose of the force-torque sensor in the flange
    math::Pose X_EI = math::Pose::Identity();  // pose of the IMU in the flange
    bool use_imu = true;
    /// s, time constant of the estimates of the accelerometer's offset and of the IMU's mounting
    /// angles, from the mean difference between its acceleration and the change of the robot's
    /// velocity; 0: the accelerometer is used without correction.
    double imu_offset_time = 5;
    /// m/s, and rad/s over 0.3 m: below this speed of the hand, as reported by the robot,
    /// accelerations are smoothed. The noise of an accelerometer times the mass of a hand of 5 kg
    /// is six times that of a good force sensor and would mask contact forces. 0: never.
    double rest_speed = 0;
    double rest_smoothing = 0.1;  // s
    /// m/s^2, difference between the mean acceleration of the last 15 ms and the smoothed one
    /// beyond which the smoothing restarts: the hand sets off or slows down, although it is still
    /// slow.
    double rest_acceleration = 0.06;
    double angular_acceleration_time = 0.01;  // s, smoothing of the differentiated gyroscope signal
    int tare_samples = 500;
    bool tare_at_start = false;
    double cutoff = 0;          // Hz, first-order low-pass of the output; 0: none
    double sample_rate = 1000;  // Hz, rate of the readings, for the cutoff
    double polarity = 1;        // -1 for a sensor that reports the wrench of the load on it
    double max_age = 0.025;     // s, maximum age of the latest reading and robot state
    // s; with older inertial data only gravity is compensated: degraded. Covers a gap of 20 ms
    // without messages, one period of 300 Hz and jitter.
    double imu_max_age = 0.027;
    double force_deviation = 0.1;    // N, standard deviation of each axis of the output
    double torque_deviation = 0.01;  // N m, likewise of the torque about the origin of S
    Source source = Source::kWrist0;
  };

  /// Throws std::invalid_argument naming the invalid option.
  explicit FtNewtonEuler(const Options& options);

  UpdateResult update(const Signals& signals, ContactSet& contacts) noexcept override;
  void reset() noexcept override;
  /// Whether the last update compensated inertial forces.
  bool used_imu() const noexcept { return used_imu_; }

 private:
  double step_between(double before, double now) noexcept;
  void follow_imu(const Stream<Inertial>& stream) noexcept;
  double moving_share(const RobotState& robot) noexcept;
  void smooth(const RobotState& robot, Eigen::Vector3d& acceleration,
              Eigen::Vector3d& angular_acceleration) noexcept;
  AccelerometerOffset::Velocity velocity(const RobotState& robot,
                                         const Eigen::Matrix3d& R_WS) const noexcept;
  LoadMotion motion(const Signals& signals) noexcept;

  Options options_;
  Eigen::Matrix3d R_SI_;
  Eigen::Vector3d p_SI_;  // origin of I in S
  math::ExponentialAverage<6> low_pass_;
  bool has_output_ = false;
  bool used_imu_ = false;

  bool has_inertial_ = false;
  /// Two samples are available, so that the gyroscope can be differentiated.
  bool has_inertial_pair_ = false;
  Inertial inertial_;
  double inertial_step_ = 0;  // s covered by the inertial data of this tick
  double usual_step_ = 0;     // s, usual interval of inertial samples; 0: not known
  Eigen::Vector3d angular_acceleration_I_ = Eigen::Vector3d::Zero();
  AccelerometerOffset offset_;
  // Accelerations, linear first, in S: of the last 15 ms, and the mean at rest.
  math::Vector6d latest_ = math::Vector6d::Zero(), smoothed_ = math::Vector6d::Zero();
  double rested_ = 0;                              // s, duration of that mean
  math::Vector6d speed_ = math::Vector6d::Zero();  // velocity of the flange, smoothed
  double speed_time_ = 0;                          // s, by the robot's clock
};

}  // namespace palpate::sensing
