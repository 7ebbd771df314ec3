#pragma once

#include "core/elasticity/body.hpp"
#include "core/elasticity/sensitivity.hpp"
#include "core/shape/feature.hpp"

namespace palpate::published_control {

/// Where the hand has to be, by a finite element model, for a feature to be at its target.
struct InverseSolution {
  bool converged = false;  // the error no longer falls; it need not be zero
  int iterations = 0;
  double error = 0;  // |target - value| that is left, in the feature's units
  math::Pose X_OG = math::Pose::Identity();
  math::Wrench F_G_O;  // of the hand on the object at the origin of G, in O, in that equilibrium
  math::Matrix6d stiffness = math::Matrix6d::Identity();  // d F_G_O / d (m, rad)
};

struct InverseOptions {
  double length = 0.25;     // m, by which rotations are scaled
  double damping = 1e-3;    // of a step, as a share of the largest singular value
  double longest = 0.03;    // m, of a step
  int iterations = 60;      // at most
  double tolerance = 1e-6;  // m, of a step at which it ends
};

/// Gauss-Newton over the pose of the hand, each step with the equilibrium of the model and its
/// exact sensitivity. Off line: it allocates and takes tens of static solutions. Throws
/// std::invalid_argument for a body without a grasp `grasp` or a target of another size.
InverseSolution solve_inverse(const elasticity::Body& body, int grasp, shape::Feature& feature,
                              const Eigen::VectorXd& target, const InverseOptions& options = {});

}  // namespace palpate::published_control
