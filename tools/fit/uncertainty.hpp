#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tools/fit/problem.hpp"
#include "tools/fit/solver.hpp"

namespace palpate::fit {

/// What is known of a parameter after the fit.
enum class Standing {
  kEstimated,
  kKnown,         // given, not sought
  kAtBound,       // what the data want is not allowed: no interval
  kUndetermined,  // the data cannot tell it
};
std::string name_of(Standing standing);

struct Estimate {
  Parameter parameter;
  Standing standing = Standing::kEstimated;
  double value = 0;
  double deviation = 0;              // standard, where estimated
  std::array<double, 2> interval{};  // 95 %, where estimated
  bool is_profile = false;           // the interval is by profile likelihood, else by curvature
};

/// A combination of parameters that the data leave open: coordinates of Problem change together by
/// these shares.
struct OpenDirection {
  double deviation = 0;  // standard, along it, in coordinates (1: all that is allowed); may be inf
  std::vector<std::pair<std::string, double>> shares;
};

/// The noise of a series, from its residuals.
struct SeriesNoise {
  double deviation = 0;  // in the series' unit
  double factor = 1;     // autocorrelation_factor
  double effective = 0;  // samples that would tell as much, were they independent
};

struct Uncertainty {
  std::vector<Estimate> estimates;  // as Problem::parameters()
  std::vector<int> determined;      // of estimates, those with an interval
  Eigen::MatrixXd covariance;       // of the values of `determined`
  Eigen::MatrixXd correlation;
  std::vector<OpenDirection> open;
  /// Of the coordinates of Problem::free(). Open directions count with a deviation of 1 at most, as
  /// far as a coordinate may go; parameters at a bound do not move.
  Eigen::MatrixXd coordinate_covariance;
  std::vector<SeriesNoise> noise;  // as Problem::series()
};

enum class Profile { kNever, kAuto, kAlways };

/// The spread of what was found. The deviation of each series' noise is that of its residuals over
/// the degrees of freedom left; a series whose residuals are autocorrelated counts as
/// n / autocorrelation_factor samples, so that C = A^-1 (sum_s f_s sigma_s^2 J_s' J_s) A^-1,
/// A = J'J of the whole. Intervals are by Student's t.
///
/// A direction is open where the standard deviation along it is more than 1 in coordinates (a
/// factor e of a logarithmic parameter, half of what is allowed of another), or its singular value
/// is below 1e-7 of the greatest; every parameter with a share in one is undetermined.
///
/// kAuto takes the profile likelihood of a parameter where curvature misleads: where at an end of
/// its interval (along the direction that curvature would have) the sum of squares has risen by
/// less than 0.8 or more than 1.25 times what curvature says.
Uncertainty find_uncertainty(const Problem& problem, const SolverOptions& options,
                             const Solution& solution, Profile profile);

}  // namespace palpate::fit
