#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::sensors {

/// Friction of the arm's gears, which the drives overcome and their torque therefore contains.
struct GearFriction {
  std::vector<double> coulomb;  // N m, one per joint; empty: none
  std::vector<double> viscous;  // N m s/rad, likewise
  double presliding = 3e-4;     // rad, decay of the Coulomb friction's difference after a reversal
};

/// Torque by friction: Dahl's model (1968) of Coulomb friction with elastic build-up, and viscous
/// friction. At rest the joint keeps the friction of its last motion.
class FrictionTorque {
 public:
  /// Throws std::invalid_argument if a list has another number of values than there are joints.
  FrictionTorque(const GearFriction& friction, int joint_count);

  /// N m, at joint positions `q`, rad, and velocities `dq`, rad/s. Call in the order of time.
  const Eigen::VectorXd& at(const Eigen::VectorXd& q, const Eigen::VectorXd& dq);

 private:
  Eigen::VectorXd coulomb_, viscous_, share_, q_, torque_;
  double presliding_;
};

}  // namespace palpate::sensors
