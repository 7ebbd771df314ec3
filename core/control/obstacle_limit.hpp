#pragma once

#include <limits>

#include "core/collision/obstacle.hpp"

namespace palpate::control {

/// Obstacle, and what a control law keeps of it.
struct LimitedObstacle {
  collision::Obstacle body;
  bool may_touch = false;    // contact is allowed; else the object keeps away from it
  double clearance = 0.005;  // m, minimum distance from the object; unless it may touch
  /// N, limit of the sum of the normal forces on it; infinite: no limit.
  double force = std::numeric_limits<double>::infinity();
};

}  // namespace palpate::control
