#pragma once

#include <optional>
#include <string>
#include <utility>

#include "rt/bus/authentication.hpp"
#include "rt/config/node.hpp"
#include "tools/driver/joint_guard.hpp"
#include "ur.hpp"

namespace palpate::ur_bridge {

/// Configuration of palpate-ur: docs/robots/ur.md.
struct Settings {
  struct Ft300Port {
    int port = 63351;
    double polarity = -1;
  };

  explicit Settings(kinematics::SerialChain given) : chain(std::move(given)) {}

  kinematics::SerialChain chain;
  std::string host;
  int rtde_port = 30004, script_port = 30002;
  Ur::Options arm;                 // without script and clock
  std::optional<Ft300Port> ft300;  // else the controller's wrench, if any
  std::string control;             // LCM URL
  bus::ChannelNames channels;      // of palpate on it
  std::optional<bus::Key> key;
  driver::JointGuard::Options guard;
};

/// Throws config::Error.
Settings read_settings(const config::Node& root);

}  // namespace palpate::ur_bridge
