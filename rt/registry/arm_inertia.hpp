#pragma once

#include <string>
#include <vector>

#include "core/kinematics/chain_dynamics.hpp"

namespace palpate::registry {

/// Inertia of an arm and of its load.
struct ArmInertia {
  /// What each joint between the root and the flange moves rigidly, with the flange but without
  /// what is beyond it, in the frame of the joint.
  std::vector<kinematics::BodyInertia> links;
  /// What the file has beyond the flange, with its joints at zero, in E.
  kinematics::BodyInertia load;
};

/// Reads it from an expanded URDF file; joints and flange as in read_urdf(). Joints off the path to
/// the flange are at zero. Throws std::invalid_argument, naming the file, if it cannot be read, the
/// link does not exist, or a mass is not above zero where a link states one.
ArmInertia read_inertia(const std::string& path, const std::string& flange);

}  // namespace palpate::registry
