#pragma once

#include <vector>

#include "core/collision/obstacle.hpp"

namespace palpate::elasticity {

/// Contact of the object with rigid obstacles; without obstacles the solver has no part in it.
struct ContactOptions {
  std::vector<collision::Obstacle> obstacles;  // at most collision::kMostObstacles
  int most = 160;                              // contact points at once; the nearest ones are kept
  double reach = 2e-3;                         // m, distance below which a point is a contact point
  /// Steps in which a point that keeps its speed may touch, for which it is a contact point even
  /// beyond `reach`, up to `farthest`: as many as a factor with its compliance takes.
  int foresight = 0;
  double farthest = 2e-2;  // m
  double skin = 4e-3;      // m, motion of a node after which candidates are searched again
  double imminent = 5e-4;  // m, distance below which a point's compliance is computed in the step
  int columns = 1;         // points whose compliance is computed in one step, >= 1
  int sweeps = 30;         // maximum number of Gauss-Seidel sweeps per correction, >= 1
  /// m, largest penetration of a point, gap under force or motion of a sticking point at which a
  /// step ends early.
  double tolerance = 1e-6;
};

}  // namespace palpate::elasticity
