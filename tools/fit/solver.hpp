#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "tools/fit/loss.hpp"
#include "tools/fit/problem.hpp"

namespace palpate::fit {

struct SolverOptions {
  Loss loss;
  int iterations = 200;
  int starts = 1;  // the plan's, then others drawn between the bounds
  int seed = 1;
  int threads = 1;
  double tolerance = 1e-10;  // relative change of the cost, and of coordinates, that ends it
  /// Called after each iteration with its number, cost and coordinates; false ends the search.
  std::function<bool(int iteration, double cost, const Eigen::VectorXd& coordinates)> progress;
};

/// Where a search ended.
struct Solution {
  Eigen::VectorXd coordinates;
  double cost = 0;  // half the sum of squared residuals after the loss
  int iterations = 0;
  bool is_converged = false;
  std::string message;
};

/// Half the sum of squares of what the loss makes of the residuals; infinite without equilibrium.
double cost_at(const Problem& problem, const Loss& loss, const Eigen::VectorXd& coordinates);

/// Levenberg-Marquardt within bounds from `start` (Ceres). Where `held` is given, coordinates of
/// true entries stay. Throws std::runtime_error where `start` itself has no equilibrium.
Solution solve(const Problem& problem, const SolverOptions& options, const Eigen::VectorXd& start,
               const std::vector<bool>& held = {});

/// The best from options.starts starts: the first is `start`, the others are uniform between the
/// bounds, logarithms at most 3 from `start`; drawn from options.seed.
Solution solve_from_many(const Problem& problem, const SolverOptions& options,
                         const Eigen::VectorXd& start);

}  // namespace palpate::fit
