#pragma once

#include "tools/lab/baselines/control/inverse_elements.hpp"
#include "tools/lab/baselines/control/rheological_chain.hpp"

namespace palpate::baselines {

struct ChainPlanOptions {
  RheologicalChain::Options chain;
  double linear_speed = 0.08;  // m/s, speed of the hand
  double until = 10;           // s, time at which the points must be at their target
  double length = 0.25;        // m, length that scales rotations
  int iterations = 12;
};

/// Pose of the hand after whose simulated motion the points of the feature are at `target`; the
/// solution contains no wrench. Offline. Throws std::invalid_argument as the chain does.
InverseSolution plan_with_chain(const elasticity::Body& body, int grasp,
                                const shape::Feature& feature, const Eigen::VectorXd& target,
                                const ChainPlanOptions& options);

}  // namespace palpate::baselines
