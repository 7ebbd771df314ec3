#pragma once

#include <Eigen/Core>

#include "core/solid/solid_material.hpp"

namespace palpate::solid {

/// Force on a rigid ball as a function of its indentation depth into a layer.
struct IndentationCurve {
  Eigen::VectorXd depth;  // divided by the ball's radius R, ascending, > 0
  Eigen::VectorXd force;  // divided by (the unit of the constants) R^2
};

struct IndentationOptions {
  double deepest = 1.2;  // divided by R
  int steps = 16;        // number of depths, evenly spaced in their square root
  /// Divided by R: element size below the ball's pole; elements grow away from there.
  double finest = 0.05;
};

/// Frictionless indentation by a ball of radius 1 of a hyperelastic layer of `thickness` (divided
/// by R), bonded to a rigid ground, at large strain. Axisymmetric nine-node quadrilaterals with the
/// volume treatment of SolidElements; contact by penalty at points of the surface. Ends before
/// `deepest` if no equilibrium is found. Throws std::invalid_argument for an invalid layer.
/// Offline: takes seconds.
IndentationCurve indent_layer(const SolidCoefficients& c, double thickness,
                              const IndentationOptions& options = {});

}  // namespace palpate::solid
