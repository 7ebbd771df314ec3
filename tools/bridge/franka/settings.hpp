#pragma once

#include <optional>
#include <string>
#include <utility>

#include "franka.hpp"
#include "rt/bus/authentication.hpp"
#include "rt/config/node.hpp"
#include "tools/driver/joint_guard.hpp"

namespace palpate::franka_bridge {

/// Configuration of palpate-franka: docs/robots/franka.md.
struct Settings {
  explicit Settings(kinematics::SerialChain given) : chain(std::move(given)) {}

  kinematics::SerialChain chain;
  std::string host;
  int port = 1337;
  int fifo_priority = 90;
  double stale = 0.05;         // s
  Franka::Options arm;         // without clock
  std::string control;         // LCM URL
  bus::ChannelNames channels;  // of palpate on it
  std::optional<bus::Key> key;
  driver::JointGuard::Options guard;
};

/// Throws config::Error.
Settings read_settings(const config::Node& root);

}  // namespace palpate::franka_bridge
