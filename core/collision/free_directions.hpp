#pragma once

#include <array>
#include <vector>

#include "core/collision/obstacle.hpp"

namespace palpate::collision {

/// Direction in which the pose of an obstacle is not known exactly: translation along x, y or z or
/// rotation about x, y or z of its frame B.
struct FreeDirection {
  int obstacle = 0;
  int axis = 0;          // 0 to 5
  double deviation = 0;  // m or rad, prior standard deviation
};

/// Largest number of free directions of all obstacles together.
inline constexpr int kMostFreeDirections = 6;

/// Directions with a positive Obstacle::pose_deviation, ordered by obstacle and axis. Throws
/// std::invalid_argument if there are more than kMostFreeDirections.
std::vector<FreeDirection> free_directions(const std::vector<Obstacle>& obstacles);

/// Changes of obstacles along and about the axes of B, m and rad, by free direction.
using FreeMotion = std::array<double, kMostFreeDirections>;

/// Displaces each obstacle by its entries of `motion`. `directions`: of these obstacles.
void displace(const std::vector<FreeDirection>& directions, const FreeMotion& motion,
              std::vector<Placement>& placements) noexcept;

}  // namespace palpate::collision
