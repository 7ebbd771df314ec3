#pragma once

#include <string>
#include <vector>

#include "tools/fit/problem.hpp"

namespace palpate::fit {

/// Largest allowed deviation of an experiment's derivatives from differences.
inline constexpr double kGradientTolerance = 1e-6;

/// The derivative with the largest deviation, for one kind of residual.
struct GradientCheck {
  std::string quantity;   // of the series
  std::string parameter;  // where the deviation is largest
  double difference = 0;  // largest over samples, relative
};

/// Compares derivatives by free coordinates with Ridders' extrapolated central differences (Press
/// et al., Numerical Recipes, section 5.7) at `coordinates`, by quantity; relative to the column's
/// largest derivative, or to 1e-4 of the prediction if that is larger, and minus twice the error
/// estimate of Ridders' scheme. Throws std::runtime_error without equilibrium.
std::vector<GradientCheck> check_gradients(const Problem& problem,
                                           const Eigen::VectorXd& coordinates);

}  // namespace palpate::fit
