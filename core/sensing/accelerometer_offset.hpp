#pragma once

#include <Eigen/Core>

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

}  // namespace palpate::sensing
