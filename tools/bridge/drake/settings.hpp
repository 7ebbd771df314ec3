#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "gripper.hpp"
#include "rt/config/node.hpp"
#include "shape_view.hpp"
#include "tools/bridge/common/protocol.hpp"
#include "tools/driver/joint_guard.hpp"

namespace palpate::drake_bridge {

/// Configuration of palpate-drake: docs/robots/drake.md.
struct Settings {
  enum class Kind { kIiwa, kPanda };

  explicit Settings(kinematics::SerialChain arm) : chain(std::move(arm)) {}

  Kind kind = Kind::kIiwa;
  kinematics::SerialChain chain;
  std::string status, command;               // channels of the arm
  std::string wrench;                        // channel of lcmt_force_torque; empty: none
  bool external_torque = false;              // tau of ROBOT_STATE, else the measured one
  double stale = 0.05;                       // s
  double follow = 0.02;                      // rad
  std::string control, housekeeping, drake;  // LCM URLs
  bus::ChannelNames channels;                // of palpate on the control URL
  int largest_message = 65000;               // Drake's in fragments, bytes; 0: dropped
  std::optional<bus::Key> key;
  driver::JointGuard::Options guard;
  std::optional<Gripper::Options> gripper;
  std::optional<ShapeView::Options> shape;

  /// Throws std::invalid_argument for a channel that is no valid name.
  std::unique_ptr<bridge::Protocol> make_protocol(bus::MessageBus& bus) const;
};

/// Throws config::Error.
Settings read_settings(const config::Node& root);

}  // namespace palpate::drake_bridge
