#pragma once

#include <Eigen/Core>
#include <array>

#include "tools/fit/problem.hpp"
#include "tools/fit/solver.hpp"

namespace palpate::fit {

/// How far one coordinate may go from where the search ended.
struct ProfileQuestion {
  const Problem& problem;
  const SolverOptions& options;
  const Solution& solution;
  Eigen::Index coordinate = 0;
  double reach = 0;           // how far curvature says
  double rise = 0;            // of the sum of squares there, which ends the interval
  Eigen::VectorXd direction;  // of all coordinates by this one, others at their best by curvature
};

/// Whether the sum of squares at an end, along `direction`, has risen by less than 0.8 or more than
/// 1.25 times `rise`, or there is no equilibrium.
bool does_curvature_mislead(const ProfileQuestion& question);

/// Where the sum of squares, least over all other coordinates, has risen by `rise`, below and
/// above; the bound where it does not rise so far (Venzon and Moolgavkar 1988, by bracketing).
std::array<double, 2> profile_interval(const ProfileQuestion& question);

}  // namespace palpate::fit
