#include "tools/fit/profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace palpate::fit {
namespace {

using Eigen::VectorXd;

VectorXd moved(const ProfileQuestion& q, double step) {
  const VectorXd x = q.solution.coordinates + step * q.direction;
  return x.cwiseMax(q.problem.lower()).cwiseMin(q.problem.upper());
}

/// Increase of the sum of squares with the coordinate `step` away and the others optimised.
double rise_at(const ProfileQuestion& q, double step) {
  SolverOptions options = q.options;
  // Sufficient for an interval of three digits.
  options.tolerance = std::max(options.tolerance, 1e-6);
  options.iterations = std::min(options.iterations, 30);
  std::vector<bool> held(static_cast<std::size_t>(q.direction.size()), false);
  held[static_cast<std::size_t>(q.coordinate)] = true;
  try {
    return 2 * (solve(q.problem, options, moved(q, step), held).cost - q.solution.cost);
  } catch (const std::runtime_error&) {  // no equilibrium so far away
    return std::numeric_limits<double>::infinity();
  }
}

/// The end on the side of `sign`; Illinois variant of false position on sqrt(rise), which is nearly
/// linear.
double end_on_side(const ProfileQuestion& q, double sign) {
  constexpr int kWider = 8, kSteps = 10;
  constexpr double kTolerance = 1e-2;
  const double at = q.solution.coordinates[q.coordinate];
  const double limit =
      sign > 0 ? q.problem.upper()[q.coordinate] - at : at - q.problem.lower()[q.coordinate];
  const double wanted = std::sqrt(q.rise);
  const auto excess = [&](double step) {
    return std::sqrt(std::max(0.0, rise_at(q, sign * step))) - wanted;
  };
  double inner = 0, inner_excess = -wanted;
  double outer = std::min(q.reach, limit), outer_excess = excess(outer);
  for (int k = 0; k < kWider && outer_excess < 0 && outer < limit; ++k) {
    inner = outer, inner_excess = outer_excess;
    outer = std::min(2 * outer, limit);
    outer_excess = excess(outer);
  }
  if (outer_excess < 0) return at + sign * limit;
  for (int k = 0; k < kSteps; ++k) {
    const bool is_finite = std::isfinite(outer_excess);
    const double part = is_finite ? inner_excess / (inner_excess - outer_excess) : 0.5;
    const double middle = inner + part * (outer - inner), value = excess(middle);
    if (std::abs(value) < kTolerance * wanted) return at + sign * middle;
    if (value < 0) {
      inner = middle, inner_excess = value;
      outer_excess /= 2;
    } else {
      outer = middle, outer_excess = value;
      inner_excess /= 2;
    }
  }
  return at + sign * (inner + outer) / 2;
}

}  // namespace

bool does_curvature_mislead(const ProfileQuestion& q) {
  if (!(q.rise > 0)) return false;
  for (const double sign : {-1.0, 1.0}) {
    const VectorXd x = moved(q, sign * q.reach);
    const double rise = 2 * (cost_at(q.problem, q.options.loss, x) - q.solution.cost);
    if (!(rise > 0.8 * q.rise && rise < 1.25 * q.rise)) return true;
  }
  return false;
}

std::array<double, 2> profile_interval(const ProfileQuestion& q) {
  if (!(q.rise > 0)) {
    const double at = q.solution.coordinates[q.coordinate];
    return {at, at};
  }
  return {end_on_side(q, -1), end_on_side(q, 1)};
}

}  // namespace palpate::fit
