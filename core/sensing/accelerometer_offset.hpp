#pragma once

#include <Eigen/Core>

namespace palpate::sensing {

/// What an accelerometer reads too much, in a frame S that moves with it: the mean, over a while,
/// of what it reads less what the robot's velocity has really changed by. Without the robot's word
/// only an arm that starts at rest could be told from an offset: in the first tenths of a second of
/// a move its acceleration is all there is to take a mean of. Nothing allocates.
class AccelerometerOffset {
 public:
  /// What the robot says of the origin of S, in W.
  struct Velocity {
    double time = 0;                                     // s, of the robot's clock
    Eigen::Vector3d linear = Eigen::Vector3d::Zero();    // m/s
    Eigen::Matrix3d R_WS = Eigen::Matrix3d::Identity();  // of then
  };

  /// `memory`: s, of the mean; its first seconds take a plain one. 0: there is no offset.
  explicit AccelerometerOffset(double memory) : memory_(memory) {}

  /// Takes an acceleration of the origin of S (m/s^2, in S, without gravity), read over the last
  /// `step` s.
  void follow(const Eigen::Vector3d& acceleration_S, double step,
              const Velocity& velocity) noexcept;
  /// The next velocity has none before it: what happened until then was not read.
  void pause() noexcept { has_velocity_ = false; }
  void reset() noexcept;

  const Eigen::Vector3d& value_S() const noexcept { return value_S_; }

 private:
  double memory_;
  Eigen::Vector3d value_S_ = Eigen::Vector3d::Zero();
  double age_ = 0;  // s of readings that it stands on
  Velocity before_;
  bool has_velocity_ = false;
};

}  // namespace palpate::sensing
