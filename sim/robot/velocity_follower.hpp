#pragma once

#include <Eigen/Core>

#include "core/math/rigid.hpp"
#include "sim/robot/joint_limits.hpp"

namespace palpate::robot {

struct FollowerOptions {
  double acceleration = 15;       // rad/s^2, acceleration limit of every joint
  double limit_margin = 0.02;     // rad, margin to each position limit
  double posture_gain = 1;        // 1/s, null-space gain towards the posture
  double singularity = 0.05;      // smallest singular value below which the joint rates are damped
  double damping = 0.05;          // damping at a singularity
  double command_time_out = 0.1;  // s without a command until the arm stops
};

/// Turns commanded velocities into a joint trajectory within limits: a flange twist by damped least
/// squares, null-space motion towards a posture (Siciliano et al., Robotics, 3.5), then limits on
/// speed, on proximity to the joints' ends and on acceleration. A command that is not renewed
/// within command_time_out is replaced by zero, reached at the acceleration limit.
class VelocityFollower {
 public:
  VelocityFollower(JointLimits limits, const FollowerOptions& options);

  /// Joint positions at rest; they also become the posture.
  void reset(const Eigen::VectorXd& q);

  /// Twist of the flange in W, linear first.
  void command_twist(const math::Twist& V_WE);
  void command_joints(const Eigen::VectorXd& joint_velocity);
  void stop();

  /// One step: `jacobian` (6 x n, linear first) of the flange and `q` as measured.
  void step(double dt, const Eigen::Matrix<double, 6, Eigen::Dynamic>& jacobian,
            const Eigen::VectorXd& q);

  const Eigen::VectorXd& position() const { return position_; }          // rad
  const Eigen::VectorXd& velocity() const { return velocity_; }          // rad/s
  const Eigen::VectorXd& acceleration() const { return acceleration_; }  // rad/s^2
  bool stale() const { return age_ > options_.command_time_out + 1e-9; }
  const JointLimits& limits() const { return limits_; }

 private:
  enum class Mode { kStop, kTwist, kJoint };
  Eigen::VectorXd resolved_rates(const Eigen::Matrix<double, 6, Eigen::Dynamic>& jacobian) const;
  /// Largest speed of joint i upwards or downwards that leaves room to brake before its limit.
  double fastest_up(Eigen::Index i) const;
  double fastest_down(Eigen::Index i) const;
  void limit(Eigen::VectorXd& target) const;

  JointLimits limits_;
  FollowerOptions options_;
  Mode mode_ = Mode::kStop;
  double age_ = 0;
  math::Vector6d twist_ = math::Vector6d::Zero();
  Eigen::VectorXd joint_velocity_, posture_, position_, velocity_, acceleration_;
};

}  // namespace palpate::robot
