#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "rt/config/node.hpp"
#include "tools/lab/faults/stream.hpp"

namespace palpate::faults {

inline constexpr int kTruthEvery = 10;  // ticks of 1 ms

/// What sensors and robot said in one closed loop of simulator and daemon, and the plant's truth.
struct Recording {
  Stream stream;  // times from 1 ms on
  /// 3 x n in O every kTruthEvery ms from kTruthEvery on: the corner nodes of configuration().
  std::vector<Eigen::Matrix3Xd> truth;
  Eigen::Vector3d target;  // m, that the feature is to go to
};

/// What the commands of every run ask for; ms.
inline constexpr int kStartTick = 20, kTargetTick = 60;

/// Configuration of every daemon here: the soft long bar of the examples as a small mesh, with the
/// overrun policy of a real-time kernel. Throws config::Error.
config::Node configuration(const std::vector<std::string>& overrides = {});

/// The feature is to go this far up from where it rests, m.
Eigen::Vector3d target_of(const Eigen::Vector3d& rest_point);

/// Runs the loop for that many ms. Throws config::Error.
Recording record_loop(int ticks);

}  // namespace palpate::faults
