#pragma once

#include <Eigen/Core>
#include <array>

#include "tools/fit/problem.hpp"
#include "tools/fit/solver.hpp"

namespace palpate::fit {

/// Interval of one coordinate around the end of the search.
struct ProfileQuestion {
  const Problem& problem;
  const SolverOptions& options;
  const Solution& solution;
  Eigen::Index coordinate = 0;
  double reach = 0;           // by curvature
  double rise = 0;            // increase of the sum of squares at the ends of the interval
  Eigen::VectorXd direction;  // of all coordinates by this one, the others optimal by curvature
};

/// Whether the sum of squares at an end, along `direction`, has risen by less than 0.8 or more than
/// 1.25 times `rise`, or there is no equilibrium.
bool does_curvature_mislead(const ProfileQuestion& question);

/// Points below and above at which the sum of squares, minimised over all other coordinates, has
/// risen by `rise`; the bound if it does not rise so far (Venzon and Moolgavkar 1988, by
/// bracketing).
std::array<double, 2> profile_interval(const ProfileQuestion& question);

}  // namespace palpate::fit
