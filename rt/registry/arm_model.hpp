#pragma once

#include <memory>
#include <string>

#include "core/control/control_law.hpp"
#include "core/kinematics/serial_chain.hpp"
#include "rt/config/node.hpp"

namespace palpate::registry {

/// Model of an arm: forward kinematics and motion limits of its joints.
struct ArmModel {
  kinematics::SerialChain chain;
  control::JointLimits limits;
  std::string urdf, flange;  // path of the file, and the link of it that is E
};

/// Reads an expanded URDF file: the actuated joints between its root link, which is W, and the link
/// `flange`, with their limits of position and speed. Throws std::invalid_argument, naming the
/// file, if it cannot be read, the link does not exist, or one of these joints is not revolute,
/// continuous or prismatic or has no limits.
kinematics::SerialChain read_urdf(const std::string& path, const std::string& flange);

/// Reads the section `robot`; nullptr if it is absent. Throws config::Error.
std::shared_ptr<const ArmModel> read_arm_model(const config::Node& root);

}  // namespace palpate::registry
