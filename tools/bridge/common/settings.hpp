#pragma once

#include <string>

#include "core/kinematics/serial_chain.hpp"
#include "rt/config/node.hpp"
#include "tools/driver/joint_guard.hpp"

// What the configurations of all bridges to arms contain. All throw config::Error.

namespace palpate::bridge {

/// `urdf` and `flange` of the section `robot`.
kinematics::SerialChain read_chain(const config::Node& robot);
/// `stale_ms` of the section `robot`; s.
double read_stale(const config::Node& robot);
/// An LCM URL of the section `bus`.
std::string read_url(const config::Node& bus, const config::Key& key, const std::string& otherwise);
/// `control` of the section `bus`.
std::string read_control_url(const config::Node& bus);
/// The section `guard`.
driver::JointGuard::Options read_guard(const config::Node& root);

}  // namespace palpate::bridge
