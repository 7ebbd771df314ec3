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
  int starts = 1;  // the plan's, then random ones within the bounds
  int seed = 1;
  int threads = 1;
  double tolerance = 1e-10;  // termination: relative change of the cost, and of coordinates
  /// Called after each iteration with its number, cost and coordinates; returning false ends the
  /// search.
  std::function<bool(int iteration, double cost, const Eigen::VectorXd& coordinates)> progress;
};

/// End of a search.
struct Solution {
  Eigen::VectorXd coordinates;
  double cost = 0;  // half the sum of squared residuals after the loss
  int iterations = 0;
  bool is_converged = false;
  std::string message;
};

/// Half the sum of squared residuals after the loss; infinite without equilibrium.
double cost_at(const Problem& problem, const Loss& loss, const Eigen::VectorXd& coordinates);

/// Levenberg-Marquardt within bounds from `start` (Ceres). If `held` is given, coordinates with
/// true entries are fixed. Throws std::runtime_error if `start` itself has no equilibrium.
Solution solve(const Problem& problem, const SolverOptions& options, const Eigen::VectorXd& start,
               const std::vector<bool>& held = {});

/// The best of options.starts searches: the first begins at `start`, the others uniformly between
/// the bounds, logarithms at most 3 from `start`; drawn from options.seed.
Solution solve_from_many(const Problem& problem, const SolverOptions& options,
                         const Eigen::VectorXd& start);

}  // namespace palpate::fit
