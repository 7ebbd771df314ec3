#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

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

/// Ratio of the number of samples to the effective number of independent ones: 1 + 2 sum rho_k over
/// the residuals' autocorrelation, summed in pairs of lags while they are positive (Geyer 1992,
/// initial positive sequence). 1 if rho_1 is within the range of white noise (1.96 / sqrt(n)).
/// Samples are taken in their order.
double autocorrelation_factor(const Eigen::VectorXd& residuals);

/// Two-sided 95 % quantile of Student's t; `freedom` at least 1.
double student_quantile(double freedom);

/// Status of a parameter after the fit.
enum class Standing {
  kEstimated,
  kKnown,         // given, not identified
  kAtBound,       // the optimum lies outside the bounds: no interval
  kUndetermined,  // not identifiable from the data
};
std::string name_of(Standing standing);

struct Estimate {
  Parameter parameter;
  Standing standing = Standing::kEstimated;
  double value = 0;
  double deviation = 0;              // standard, if estimated
  std::array<double, 2> interval{};  // 95 %, if estimated
  bool is_profile = false;  // the interval is by profile likelihood, otherwise by curvature
};

/// A combination of parameters that the data do not determine: coordinates of Problem change
/// together in these proportions.
struct OpenDirection {
  double deviation =
      0;  // standard, along it, in coordinates (1: the whole allowed range); may be inf
  std::vector<std::pair<std::string, double>> shares;
};

/// The noise of a series, from its residuals.
struct SeriesNoise {
  double deviation = 0;  // in the series' unit
  double factor = 1;     // autocorrelation_factor
  double effective = 0;  // effective number of independent samples
};

struct Uncertainty {
  std::vector<Estimate> estimates;  // as Problem::parameters()
  std::vector<int> determined;      // of estimates with an interval
  Eigen::MatrixXd covariance;       // of the values of `determined`
  Eigen::MatrixXd correlation;
  std::vector<OpenDirection> open;
  /// Of the coordinates of Problem::free(). Open directions count with a standard deviation of at
  /// most 1, the range of a coordinate; parameters at a bound are fixed.
  Eigen::MatrixXd coordinate_covariance;
  std::vector<SeriesNoise> noise;  // as Problem::series()
};

enum class Profile { kNever, kAuto, kAlways };

/// Uncertainty of the estimates. The standard deviation of each series' noise is that of its
/// residuals over the remaining degrees of freedom; a series with autocorrelated residuals counts
/// as n / autocorrelation_factor samples, so that C = A^-1 (sum_s f_s sigma_s^2 J_s' J_s) A^-1, A =
/// J'J over all series. Intervals are by Student's t.
///
/// A direction is open if the standard deviation along it is more than 1 in coordinates (a factor e
/// of a logarithmic parameter, half of the allowed range of another), or its singular value is
/// below 1e-7 of the largest; every parameter with a share in one is undetermined.
///
/// kAuto uses the profile likelihood of a parameter if curvature is misleading: if at an end of its
/// interval (along the direction given by curvature) the sum of squares has risen by less than 0.8
/// or more than 1.25 times the value predicted by curvature.
Uncertainty find_uncertainty(const Problem& problem, const SolverOptions& options,
                             const Solution& solution, Profile profile);

}  // namespace palpate::fit
