#pragma once

#include <string>
#include <vector>

#include "tools/fit/problem.hpp"

namespace palpate::fit {

/// Largest allowed difference of an experiment's derivatives from differences.
inline constexpr double kGradientTolerance = 1e-6;

/// Of one kind of residual, the derivative that is furthest off.
struct GradientCheck {
  std::string quantity;   // of the series
  std::string parameter;  // where it is furthest off
  double difference = 0;  // largest over samples, relative
};

/// Compares derivatives by free coordinates with Ridders' extrapolated central differences (Press
/// et al., Numerical Recipes, section 5.7) at `coordinates`, by quantity; relative to the column's
/// largest derivative, or to 1e-4 of what is predicted where that is more, and less twice what
/// Ridders' scheme says of its own error. Throws std::runtime_error without equilibrium.
std::vector<GradientCheck> check_gradients(const Problem& problem,
                                           const Eigen::VectorXd& coordinates);

}  // namespace palpate::fit
