#pragma once

#include <Eigen/Core>

#include "core/kinematics/serial_chain.hpp"

namespace palpate::control {

/// What the joints of an arm may do, one entry a joint; rad, s (m where it slides).
struct JointLimits {
  kinematics::SerialChain::Joints lower, upper;  // of position
  kinematics::SerialChain::Joints speed, acceleration;

  int count() const noexcept { return static_cast<int>(speed.size()); }
  bool empty() const noexcept { return count() == 0; }
  /// Throws std::invalid_argument where sizes differ, a range is empty or a limit not positive.
  void check() const;
};

/// The joints of the arm that holds the grasp, as they are.
struct JointInputs {
  kinematics::SerialChain::Joints q;
  kinematics::SerialChain::Jacobian V_O_G_by_joints;  // twist of the origin of G, in O
};

}  // namespace palpate::control
