#include "tools/fit/fit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace palpate::fit {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Errors errors_of(const Problem& problem, std::size_t place, const VectorXd& predicted,
                 bool of_fitted) {
  const Series& series = problem.series_at(place);
  Errors errors;
  std::vector<double> sizes;
  double sum = 0;
  for (Index i = 0; i < predicted.size(); ++i) {
    if (problem.is_fitted(place, i) != of_fitted) continue;
    const double error = predicted[i] - series.measured[i];
    sizes.push_back(std::abs(error));
    sum += error * error;
  }
  if (sizes.empty()) return errors;
  errors.count = static_cast<Index>(sizes.size());
  errors.rmse = std::sqrt(sum / static_cast<double>(sizes.size()));
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  errors.median = *middle;
  if (sizes.size() % 2 == 0)
    errors.median = (errors.median + *std::max_element(sizes.begin(), middle)) / 2;
  const double range = series.measured.maxCoeff() - series.measured.minCoeff();
  errors.percent = range > 0 ? 100 * errors.rmse / range : 0;
  return errors;
}

std::vector<SeriesFit> score(const Problem& problem, const VectorXd& coordinates) {
  std::vector<VectorXd> predictions(problem.members().size());
  for (std::size_t m = 0; m < predictions.size(); ++m)
    if (!problem.predict(static_cast<int>(m), coordinates, predictions[m], nullptr))
      throw std::runtime_error("no equilibrium with the parameters that were found");
  std::vector<SeriesFit> result;
  for (std::size_t s = 0; s < problem.series().size(); ++s) {
    const SeriesPlace& place = problem.series()[s];
    const Series& series = problem.series_at(s);
    const auto member = static_cast<std::size_t>(place.member);
    SeriesFit fit;
    fit.recording = problem.members()[member].experiment->name();
    fit.quantity = series.quantity;
    fit.unit = series.unit;
    fit.predicted = predictions[member].segment(place.row, series.measured.size());
    fit.fitted = errors_of(problem, s, fit.predicted, true);
    fit.held_out = errors_of(problem, s, fit.predicted, false);
    result.push_back(std::move(fit));
  }
  return result;
}

/// Standard deviations estimated from the residuals, none below a millionth of its range; true if
/// one has changed by more than 5 %.
bool reweigh(Problem& problem, const std::vector<SeriesFit>& series) {
  std::vector<double> deviations = problem.deviations();
  bool has_moved = false;
  for (std::size_t s = 0; s < series.size(); ++s) {
    if (series[s].fitted.count == 0) continue;
    const VectorXd& measured = problem.series_at(s).measured;
    const double least = 1e-6 * (measured.maxCoeff() - measured.minCoeff());
    const double to = std::max({series[s].fitted.rmse, least, 1e-300});
    has_moved = has_moved || std::abs(std::log(to / deviations[s])) > 0.05;
    deviations[s] = to;
  }
  problem.set_deviations(std::move(deviations));
  return has_moved;
}

}  // namespace

const Estimate* Fit::find(const std::string& name) const {
  for (const Estimate& estimate : uncertainty.estimates)
    if (estimate.parameter.name == name) return &estimate;
  return nullptr;
}

Fit fit_problem(Problem& problem, const FitOptions& options, const VectorXd& start) {
  constexpr int kRounds = 4;
  const auto begin = std::chrono::steady_clock::now();
  const Problem::Count before = problem.count();
  Fit fit;
  fit.solution = solve_from_many(problem, options.solver, start);
  fit.series = score(problem, fit.solution.coordinates);
  const bool is_robust = options.solver.loss.kind != Loss::Kind::kNone;
  const bool has_several = problem.series().size() > 1;
  for (int round = 0; options.is_reweighed && (has_several || is_robust) && round < kRounds;
       ++round) {
    if (!reweigh(problem, fit.series)) break;
    fit.solution = solve(problem, options.solver, fit.solution.coordinates);
    fit.series = score(problem, fit.solution.coordinates);
  }
  fit.uncertainty = find_uncertainty(problem, options.solver, fit.solution, options.profile);
  fit.count = {problem.count().predictions - before.predictions,
               problem.count().jacobians - before.jacobians};
  fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return fit;
}

}  // namespace palpate::fit
