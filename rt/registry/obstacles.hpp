#pragma once

#include <optional>
#include <vector>

#include "core/collision/free_directions.hpp"
#include "core/control/obstacle_limit.hpp"
#include "core/kinematics/serial_chain.hpp"
#include "rt/config/node.hpp"

namespace palpate::registry {

/// What carries an obstacle. A: the frame that carries it, W where nothing does.
struct ObstacleCarrier {
  enum class Kind { kFixed, kLink, kMessages };
  Kind kind = Kind::kFixed;
  math::Pose X_AB = math::Pose::Identity();     // pose of the shape's frame
  std::optional<kinematics::SerialChain> link;  // from W to the link A
  double timeout = 0.1;  // s without a message after which the obstacle's place counts as unknown
};

/// Obstacle of the configuration.
struct ConfiguredObstacle {
  control::LimitedObstacle limited;
  ObstacleCarrier carrier;
};

/// Longest name of an obstacle, for messages.
inline constexpr int kLongestObstacleName = 23;

/// Directions in which poses are not known exactly, in the order of the obstacles.
std::vector<collision::FreeDirection> free_directions(
    const std::vector<ConfiguredObstacle>& obstacles);

/// Reads `obstacles`, the rigid bodies that the object may meet, with poses in O: those of a link
/// are not placed, nor those that messages move, without `pose`. Throws config::Error.
std::vector<ConfiguredObstacle> read_obstacles(const config::Node& root, const math::Pose& X_WO);

}  // namespace palpate::registry
