#pragma once

#include <Eigen/Core>

#include "core/kinematics/serial_chain.hpp"

namespace palpate::control {

/// Motion limits of the joints of an arm, one entry per joint; rad, s (m for prismatic joints).
struct JointLimits {
  kinematics::SerialChain::Joints lower, upper;  // position limits
  kinematics::SerialChain::Joints speed, acceleration;

  int count() const noexcept { return static_cast<int>(speed.size()); }
  bool empty() const noexcept { return count() == 0; }
  /// Throws std::invalid_argument if sizes differ, a range is empty or a limit is not positive.
  void check() const;
};

/// Present state of the joints of the arm that holds the grasp.
struct JointInputs {
  kinematics::SerialChain::Joints q;
  /// Jacobian of the twist of the origin of G, in O
  kinematics::SerialChain::Jacobian V_O_G_by_joints;
};

}  // namespace palpate::control
