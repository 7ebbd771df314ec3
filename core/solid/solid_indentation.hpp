#pragma once

#include <Eigen/Core>

#include "core/solid/solid_material.hpp"

namespace palpate::solid {

/// Force on a rigid ball by the depth to which it is pressed into a layer.
struct IndentationCurve {
  Eigen::VectorXd depth;  // over the ball's radius R, rising, from above 0
  Eigen::VectorXd force;  // over (the unit of the constants) R^2
};

struct IndentationOptions {
  double deepest = 1.2;  // over R
  int steps = 16;        // depths, evenly spaced in their square root
  double finest = 0.05;  // over R: elements below the ball's pole; they grow away from there
};

/// A frictionless ball of radius 1 pressed into a layer of `thickness` (over R), bonded to a rigid
/// ground, of a hyperelastic solid at large strain. Axisymmetric nine-node quadrilaterals that keep
/// their volume as SolidElements do; contact by penalty at points of the surface. Ends before
/// `deepest` where no equilibrium is found any more. Throws std::invalid_argument for what is no
/// layer. Off line: seconds.
IndentationCurve indent_layer(const SolidCoefficients& c, double thickness,
                              const IndentationOptions& options = {});

}  // namespace palpate::solid
