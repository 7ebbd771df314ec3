#pragma once

#include <memory>
#include <string>

#include "core/control/joint_limits.hpp"
#include "core/kinematics/serial_chain.hpp"
#include "rt/config/node.hpp"

namespace palpate::registry {

/// The arm as its makers describe it: how its joints move the flange, and how far they may go.
struct ArmModel {
  kinematics::SerialChain chain;
  control::JointLimits limits;
};

/// Reads an expanded URDF file: the joints that move between its root link, which is W, and the
/// link `flange`, with their limits of position and speed. Throws std::invalid_argument, naming the
/// file, where it cannot be read, there is no such link, or one of these joints is neither
/// revolute, continuous nor prismatic or has no limits.
kinematics::SerialChain read_urdf(const std::string& path, const std::string& flange);

/// Reads the section `robot`; nullptr where there is none. Throws config::Error.
std::shared_ptr<const ArmModel> read_arm_model(const config::Node& root);

}  // namespace palpate::registry
