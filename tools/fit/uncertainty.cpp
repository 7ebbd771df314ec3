#include "tools/fit/uncertainty.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/math/singular_values.hpp"

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
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
  held[q.coordinate] = true;
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

constexpr double kInfiniteDeviation = std::numeric_limits<double>::infinity();

/// Residuals of every series at the end of the search, raw and weighted by the loss.
struct Linearised {
  std::vector<VectorXd> residuals;  // in deviations
  std::vector<VectorXd> counted;
  std::vector<MatrixXd> jacobians;  // of `counted`
};

Linearised linearise(const Problem& problem, const Loss& loss, const VectorXd& x) {
  Linearised result;
  for (std::size_t m = 0; m < problem.members().size(); ++m) {
    VectorXd r;
    MatrixXd J;
    if (!problem.residuals(static_cast<int>(m), x, r, &J))
      throw std::runtime_error("no equilibrium with the parameters that were found");
    VectorXd counted = r;
    for (Index i = 0; i < r.size(); ++i) J.row(i) *= loss.apply(counted[i]);
    Index row = 0;
    for (std::size_t s = 0; s < problem.series().size(); ++s) {
      if (problem.series()[s].member != static_cast<int>(m)) continue;
      const Index n = problem.fitted_count(s);
      result.residuals.push_back(r.segment(row, n));
      result.counted.push_back(counted.segment(row, n));
      result.jacobians.push_back(J.middleRows(row, n));
      row += n;
    }
  }
  return result;
}

/// Degrees of freedom are subtracted from the series in proportion to their samples.
std::vector<SeriesNoise> find_noise(const Problem& problem, const Linearised& at) {
  const auto all = static_cast<double>(problem.fitted_count());
  const double left = std::max(1.0, all - static_cast<double>(problem.free().size()));
  std::vector<SeriesNoise> noise;
  for (std::size_t s = 0; s < at.counted.size(); ++s) {
    const auto n = static_cast<double>(at.counted[s].size());
    SeriesNoise one;
    one.factor = autocorrelation_factor(at.counted[s]);
    one.effective = n / one.factor;
    one.deviation =
        n > 0 ? problem.deviations()[s] * std::sqrt(at.counted[s].squaredNorm() / n * all / left)
              : 0;
    noise.push_back(one);
  }
  return noise;
}

/// Covariance of the coordinates `moving` and the open directions of the data.
struct Spread {
  MatrixXd covariance;        // of the coordinates, without open directions
  MatrixXd inverse;           // (J'J)^-1, likewise
  MatrixXd bounded;           // covariance, open directions with a deviation of 1 at most
  std::vector<bool> is_open;  // by moving coordinate
};

Spread find_spread(const Problem& problem, const Linearised& at,
                   const std::vector<SeriesNoise>& noise, const std::vector<Index>& moving,
                   std::vector<OpenDirection>& open) {
  const auto n = static_cast<Index>(moving.size());
  MatrixXd A = MatrixXd::Zero(n, n), B = A, white = A;
  for (std::size_t s = 0; s < at.jacobians.size(); ++s) {
    MatrixXd J(at.jacobians[s].rows(), n);
    for (Index k = 0; k < n; ++k) J.col(k) = at.jacobians[s].col(moving[k]);
    const double sigma = noise[s].deviation / problem.deviations()[s];
    const double variance = noise[s].factor * sigma * sigma;
    const MatrixXd JJ = J.transpose() * J;
    A += JJ;
    B += variance * JJ;
    white += JJ / std::max(variance, 1e-300);
  }
  // Singular values of the whitened Jacobian: the inverse of the standard deviation along each
  // direction.
  const Eigen::JacobiSVD<MatrixXd> svd(white, Eigen::ComputeFullV);
  const VectorXd singular = svd.singularValues().cwiseMax(0).cwiseSqrt();
  std::vector<Index> kept;
  MatrixXd unknown = MatrixXd::Zero(n, n);
  Spread spread;
  spread.is_open.assign(static_cast<std::size_t>(n), false);
  constexpr double kShare = 0.05;
  for (Index k = 0; k < n; ++k) {
    const bool is_null = singular[k] <= 1e-7 * singular[0];
    if (!is_null && singular[k] >= 1) {
      kept.push_back(k);
      continue;
    }
    OpenDirection direction;
    direction.deviation = is_null ? kInfiniteDeviation : 1 / singular[k];
    const double most = std::min(direction.deviation, 1.0);
    unknown += most * most * svd.matrixV().col(k) * svd.matrixV().col(k).transpose();
    for (Index i = 0; i < n; ++i) {
      const double share = svd.matrixV()(i, k);
      if (std::abs(share) < kShare) continue;
      const int parameter = problem.free()[moving[i]];
      direction.shares.push_back({problem.parameters()[parameter].name, share});
      spread.is_open[i] = true;
    }
    open.push_back(std::move(direction));
  }
  MatrixXd basis(n, static_cast<Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k)
    basis.col(static_cast<Index>(k)) = svd.matrixV().col(kept[k]);
  const MatrixXd inner = basis.transpose() * A * basis;
  spread.inverse = basis * inner.ldlt().solve(MatrixXd(basis.transpose()));
  spread.covariance = spread.inverse * B * spread.inverse;
  spread.bounded = spread.covariance + unknown;
  return spread;
}

bool is_at_bound(double x, double lower, double upper) {
  const double tolerance = 1e-7 * std::max(1.0, upper - lower);
  return x - lower < tolerance || upper - x < tolerance;
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

double autocorrelation_factor(const Eigen::VectorXd& residuals) {
  const Eigen::Index n = residuals.size();
  if (n < 4) return 1;
  const Eigen::VectorXd r = residuals.array() - residuals.mean();
  const double variance = r.squaredNorm();
  if (!(variance > 0)) return 1;
  const auto rho = [&](Eigen::Index lag) {
    return lag < n ? r.head(n - lag).dot(r.tail(n - lag)) / variance : 0.0;
  };
  const double white = 1.96 / std::sqrt(static_cast<double>(n));
  if (rho(1) < white) return 1;
  double sum = rho(1);
  for (Eigen::Index lag = 2; lag + 1 < n; lag += 2) {
    const double pair = rho(lag) + rho(lag + 1);
    if (!(pair > 0)) break;
    sum += pair;
  }
  return std::clamp(1 + 2 * sum, 1.0, static_cast<double>(n) / 2);
}

double student_quantile(double freedom) {
  return boost::math::quantile(boost::math::students_t(std::max(freedom, 1.0)), 0.975);
}

std::string name_of(Standing standing) {
  constexpr const char* kNames[] = {"estimated", "known", "at bound", "undetermined"};
  return kNames[static_cast<int>(standing)];
}

Uncertainty find_uncertainty(const Problem& problem, const SolverOptions& options,
                             const Solution& solution, Profile profile) {
  const VectorXd& x = solution.coordinates;
  const Linearised at = linearise(problem, options.loss, x);
  Uncertainty result;
  result.noise = find_noise(problem, at);
  const VectorXd values = problem.values(x), lower = problem.lower(), upper = problem.upper();
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    Estimate estimate;
    estimate.parameter = problem.parameters()[i];
    estimate.value = values[i];
    estimate.standing = Standing::kKnown;
    result.estimates.push_back(estimate);
  }
  std::vector<Index> moving;
  for (std::size_t i = 0; i < problem.free().size(); ++i) {
    const auto k = static_cast<Index>(i);
    const bool is_bound = is_at_bound(x[k], lower[k], upper[k]);
    result.estimates[problem.free()[i]].standing =
        is_bound ? Standing::kAtBound : Standing::kEstimated;
    if (!is_bound) moving.push_back(k);
  }
  const auto free_count = static_cast<Index>(problem.free().size());
  result.coordinate_covariance.setZero(free_count, free_count);
  if (moving.empty()) return result;

  const Spread spread = find_spread(problem, at, result.noise, moving, result.open);
  for (std::size_t i = 0; i < moving.size(); ++i)
    for (std::size_t j = 0; j < moving.size(); ++j)
      result.coordinate_covariance(moving[i], moving[j]) =
          spread.bounded(static_cast<Index>(i), static_cast<Index>(j));
  double effective = 0;
  for (const SeriesNoise& noise : result.noise) effective += noise.effective;
  const double t = student_quantile(effective - static_cast<double>(moving.size()));
  std::vector<Index> determined_rows;
  for (std::size_t k = 0; k < moving.size(); ++k) {
    const auto parameter = static_cast<std::size_t>(problem.free()[moving[k]]);
    Estimate& estimate = result.estimates[parameter];
    if (spread.is_open[k]) {
      estimate.standing = Standing::kUndetermined;
      continue;
    }
    const auto row = static_cast<Index>(k);
    const double sigma = std::sqrt(spread.covariance(row, row));
    estimate.deviation =
        sigma * std::abs(problem.slope(static_cast<int>(parameter), estimate.value));
    ProfileQuestion question{problem, options, solution, moving[k], t * sigma, 0, {}};
    question.rise = spread.inverse(row, row) > 0
                        ? question.reach * question.reach / spread.inverse(row, row)
                        : 0;
    question.direction = VectorXd::Zero(x.size());
    for (std::size_t j = 0; j < moving.size(); ++j)
      question.direction[moving[j]] =
          spread.inverse(static_cast<Index>(j), row) / spread.inverse(row, row);
    std::array<double, 2> ends = {x[moving[k]] - t * sigma, x[moving[k]] + t * sigma};
    estimate.is_profile = profile == Profile::kAlways ||
                          (profile == Profile::kAuto && does_curvature_mislead(question));
    if (estimate.is_profile) ends = profile_interval(question);
    for (std::size_t side = 0; side < 2; ++side)
      estimate.interval[side] = problem.to_value(
          static_cast<int>(parameter), std::clamp(ends[side], lower[moving[k]], upper[moving[k]]));
    result.determined.push_back(static_cast<int>(parameter));
    determined_rows.push_back(row);
  }
  const MatrixXd of_coordinates = spread.covariance(determined_rows, determined_rows);
  VectorXd slopes(result.determined.size());
  for (Index i = 0; i < slopes.size(); ++i)
    slopes[i] = problem.slope(result.determined[i], values[result.determined[i]]);
  const VectorXd scale = of_coordinates.diagonal();
  result.covariance.resizeLike(of_coordinates);
  result.correlation = of_coordinates;
  for (Index i = 0; i < slopes.size(); ++i)
    for (Index j = 0; j < slopes.size(); ++j) {
      result.covariance(i, j) = of_coordinates(i, j) * slopes[i] * slopes[j];
      result.correlation(i, j) /= std::sqrt(scale[i] * scale[j]);
    }
  return result;
}

}  // namespace palpate::fit
