#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tools/fit/problem.hpp"

namespace palpate::fit {

/// Weight of a residual r, in standard deviations. Least squares are over rho(r) with rho(r)^2 =
///   none    r^2
///   huber   r^2 up to the scale a, then 2 a |r| - a^2 (Huber 1964)
///   cauchy  a^2 log(1 + r^2 / a^2)
struct Loss {
  enum class Kind { kNone, kHuber, kCauchy };
  Kind kind = Kind::kNone;
  double scale = 2;

  /// Replaces the residual by rho(r), and returns its slope.
  double apply(double& r) const {
    const double a = scale, size = std::abs(r);
    if (kind == Kind::kNone || size == 0) return 1;
    double slope = 1;
    if (kind == Kind::kHuber && size > a) {
      const double rho = std::sqrt(2 * a * size - a * a);
      slope = a / rho;
      r = std::copysign(rho, r);
    } else if (kind == Kind::kCauchy) {
      const double relative = size * size / (a * a);
      const double rho = a * std::sqrt(std::log1p(relative));
      slope = size / (rho * (1 + relative));
      r = std::copysign(rho, r);
    }
    return slope;
  }
};

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
