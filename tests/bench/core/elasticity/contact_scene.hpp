#pragma once

#include <vector>

#include "core/collision/obstacle.hpp"
#include "core/elasticity/body.hpp"

namespace palpate::bench {

/// The quadratic bar of 475 nodes, fixed at x = 0, whose other end a hand lowers below the height
/// of a table under its middle, turns, and moves along and across it.
struct ContactScene {
  /// `table`: whether there is one; `friction`: its coefficient.
  ContactScene(bool table, double friction);

  math::Pose hand(double t) const;  // X_OG after t s

  elasticity::Body body;
  std::vector<collision::Obstacle> obstacles;
};

inline constexpr double kContactStep = 1e-3;  // s

}  // namespace palpate::bench
