#pragma once

#include "core/elasticity/body.hpp"
#include "core/elasticity/sensitivity.hpp"
#include "core/shape/feature.hpp"

namespace palpate::baselines {

/// Pose of the hand for which a finite element model reaches the target of a feature.
struct InverseSolution {
  bool converged = false;  // the error no longer decreases; it need not be zero
  int iterations = 0;
  double error = 0;  // remaining |target - value|, in the feature's units
  math::Pose X_OG = math::Pose::Identity();
  /// Wrench of the hand on the object at the origin of G, in O, at that equilibrium.
  math::Wrench F_G_O;
  math::Matrix6d stiffness = math::Matrix6d::Identity();  // d F_G_O / d (m, rad)
};

struct InverseOptions {
  double length = 0.25;     // m, length that scales rotations
  double damping = 1e-3;    // of a step, relative to the largest singular value
  double longest = 0.03;    // m, maximum step
  int iterations = 60;      // maximum number
  double tolerance = 1e-6;  // m, step at which the iteration ends
};

/// Gauss-Newton iteration over the pose of the hand, each step with the equilibrium of the model
/// and its exact sensitivity. Offline: allocates and takes tens of static solutions. Throws
/// std::invalid_argument if the body has no grasp `grasp` or the target has a different size.
InverseSolution solve_inverse(const elasticity::Body& body, int grasp, shape::Feature& feature,
                              const Eigen::VectorXd& target, const InverseOptions& options = {});

}  // namespace palpate::baselines
