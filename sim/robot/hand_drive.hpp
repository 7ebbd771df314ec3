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
/// and a damper pull each joint there, integrated implicitly (a phalanx is far too light for an
/// explicit spring of this stiffness at 1 kHz; Tan, Liu and Turk 2011), the spring never with more
/// than the torque limit. Weight is fed forward; what an object exerts is not, so that fingers
/// yield to it. Until the first command the joints are rigid.
class HandDrive {
 public:
  /// The joints belong to the caller's skeleton, which must outlive this.
  HandDrive(std::vector<dart::dynamics::DegreeOfFreedom*> joints, const HandOptions& options);

  int joint_count() const { return static_cast<int>(joints_.size()); }
  const std::vector<dart::dynamics::DegreeOfFreedom*>& joints() const { return joints_; }
  const JointLimits& limits() const { return limits_; }

  /// At rest in `q` (rad), rigid again.
  void reset(const Eigen::VectorXd& q);

  /// Joint targets, rad; cut to the limits.
  void command(const Eigen::VectorXd& target);

  /// Sets the servos for one step. `load` (N m, of the whole skeleton) is what holds the fingers
  /// still in the hand.
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
