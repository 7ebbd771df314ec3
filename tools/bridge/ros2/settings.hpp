#pragma once

#include <optional>
#include <string>

#include "cloud_relay.hpp"
#include "core/kinematics/serial_chain.hpp"
#include "joint_state_arm.hpp"
#include "participant.hpp"
#include "requests.hpp"
#include "rt/config/node.hpp"
#include "shape_marker.hpp"
#include "telemetry.hpp"
#include "tools/driver/joint_guard.hpp"

namespace palpate::ros2_bridge {

/// Configuration of palpate-ros2: docs/robots/ros2.md. What is absent is not connected.
struct Settings {
  struct Robot {
    kinematics::SerialChain chain;
    double stale = 0.05;  // s
    JointStateArm::Options arm;
    driver::JointGuard::Options guard;
  };
  struct Wrench {
    std::string topic;
    int polarity = -1;
  };

  Participant::Options participant;
  Clock clock;
  std::optional<Robot> robot;
  std::optional<Wrench> wrench;
  std::string imu;  // topics; empty: none
  std::optional<CloudRelay::Options> cloud;
  Telemetry::Options telemetry;
  std::optional<ShapeMarker::Options> shape;
  std::string diagnostics;
  std::string services, commands;  // prefix of services, topic of commands; empty: none
  std::optional<TargetTopic::Options> target;
  std::string control, housekeeping;  // LCM URLs
  bus::ChannelNames channels;         // of palpate on the control URL
  std::optional<bus::Key> key;
};

/// Throws config::Error.
Settings read_settings(const config::Node& root);

}  // namespace palpate::ros2_bridge
