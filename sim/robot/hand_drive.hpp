#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/robot/joint_limits.hpp"

namespace dart::dynamics {
class DegreeOfFreedom;
}

namespace palpate::robot {

struct HandOptions {
  double stiffness = 2;   // N m/rad, of every joint's position servo
  double damping = 0.04;  // N m s/rad
};

/// Position servos of a hand's joints. Targets are approached at the joints' speed limits; a spring
/// and a damper pull each joint towards its target, integrated implicitly (a phalanx is far too
/// light for an explicit spring of this stiffness at 1 kHz; Tan, Liu and Turk 2011). The spring
/// torque never exceeds the torque limit. Gravity is compensated by feed-forward; an object's
/// reaction is not, so that fingers comply with it. Joints are rigid until the first command.
class HandDrive {
 public:
  /// The joints belong to the caller's skeleton, which must outlive this object.
  HandDrive(std::vector<dart::dynamics::DegreeOfFreedom*> joints, const HandOptions& options);

  int joint_count() const { return static_cast<int>(joints_.size()); }
  const std::vector<dart::dynamics::DegreeOfFreedom*>& joints() const { return joints_; }
  const JointLimits& limits() const { return limits_; }

  /// Resets to rest at `q` (rad), with rigid joints.
  void reset(const Eigen::VectorXd& q);

  /// Joint targets, rad; clamped to the limits.
  void command(const Eigen::VectorXd& target);

  /// Sets the servos for one step. `load` (N m, of the whole skeleton) is the torque that holds the
  /// fingers still relative to the hand.
  void step(double dt, const Eigen::VectorXd& load);

  /// Spring torque and load of the last step, N m; zero while rigid.
  const Eigen::VectorXd& torque() const { return torque_; }

 private:
  std::vector<dart::dynamics::DegreeOfFreedom*> joints_;
  HandOptions options_;
  JointLimits limits_;
  bool rigid_ = true;
  Eigen::VectorXd target_, reference_, torque_;
};

}  // namespace palpate::robot
