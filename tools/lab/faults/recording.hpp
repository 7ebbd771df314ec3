#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "rt/client/client.hpp"
#include "rt/config/node.hpp"
#include "tools/lab/faults/stream.hpp"

namespace palpate::faults {

inline constexpr int kTruthEvery = 10;  // ticks of 1 ms

/// Messages of sensors and robot in one closed loop of simulator and daemon, and the plant's ground
/// truth.
struct Recording {
  Stream stream;  // times from 1 ms on
  /// 3 x n in O every kTruthEvery ms from kTruthEvery on: the corner nodes of configuration().
  std::vector<Eigen::Matrix3Xd> truth;
  Eigen::Vector3d target;  // m, target of the feature
};

/// Times of the commands in every run; ms.
inline constexpr int kStartTick = 20, kTargetTick = 60;

/// Configuration of every daemon here: the long soft bar of the examples as a small mesh, with the
/// overrun policy of a real-time kernel. Throws config::Error.
config::Node configuration(const std::vector<std::string>& overrides = {});

/// Distance of the feature's target above its rest position, m.
Eigen::Vector3d target_of(const Eigen::Vector3d& rest_point);

/// As a message for the feature of the configuration.
std::vector<shape_target_t> message_of(const Eigen::Vector3d& target);

/// Runs the loop for that many ms. Throws config::Error.
Recording record_loop(int ticks);

}  // namespace palpate::faults
