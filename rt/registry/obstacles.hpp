#pragma once

#include <vector>

#include "core/collision/obstacle.hpp"
#include "rt/config/node.hpp"

namespace palpate::registry {

/// Reads `obstacles`, the rigid bodies at rest that the object may touch, with poses in O. Throws
/// config::Error.
std::vector<collision::Obstacle> read_obstacles(const config::Node& root, const math::Pose& X_WO);

}  // namespace palpate::registry
