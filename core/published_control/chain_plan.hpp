#pragma once

#include "core/published_control/inverse_elements.hpp"
#include "core/published_control/rheological_chain.hpp"

namespace palpate::published_control {

struct ChainPlanOptions {
  RheologicalChain::Options chain;
  double linear_speed = 0.08;  // m/s, of the hand
  double until = 10;           // s, when the points shall be at their target
  double length = 0.25;        // m, by which rotations are scaled
  int iterations = 12;
};

/// The hand's pose after whose simulated motion the points of the feature are at `target`; the
/// solution holds no wrench. Off line. Throws std::invalid_argument as the chain does.
InverseSolution plan_with_chain(const elasticity::Body& body, int grasp,
                                const shape::Feature& feature, const Eigen::VectorXd& target,
                                const ChainPlanOptions& options);

}  // namespace palpate::published_control
