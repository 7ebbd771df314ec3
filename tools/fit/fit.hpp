#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/fit/problem.hpp"
#include "tools/fit/solver.hpp"
#include "tools/fit/uncertainty.hpp"

namespace palpate::fit {

struct FitOptions {
  SolverOptions solver;
  Profile profile = Profile::kAuto;
  /// Series are reweighted by the noise estimated from their residuals, until it converges.
  bool is_reweighed = true;
};

/// Errors of predicted samples.
struct Errors {
  Eigen::Index count = 0;
  double median = 0;  // of |error|, in the series' unit
  double rmse = 0;
  double percent = 0;  // rmse in % of the range of the whole series
};

struct SeriesFit {
  std::string recording;
  std::string quantity;
  std::string unit;
  Eigen::VectorXd predicted;  // by sample
  Errors fitted;
  Errors held_out;
};

/// Solution of a problem.
struct Fit {
  Solution solution;
  Uncertainty uncertainty;
  std::vector<SeriesFit> series;  // as Problem::series()
  Problem::Count count;           // of all evaluations, for search and for intervals
  double seconds = 0;

  /// Estimate of a parameter; null if there is none of the name.
  const Estimate* find(const std::string& name) const;
};

/// Throws std::runtime_error as solve() does.
Fit fit_problem(Problem& problem, const FitOptions& options, const Eigen::VectorXd& start);

}  // namespace palpate::fit
