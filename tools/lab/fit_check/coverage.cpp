#include "tools/lab/fit_check/coverage.hpp"

#include <stdexcept>

#include "core/math/random.hpp"

namespace palpate::fit_check {

Synthetic::Synthetic(std::shared_ptr<const fit::Experiment> mechanics, const Eigen::VectorXd& truth,
                     int seed)
    : Experiment(mechanics->name()), mechanics_(std::move(mechanics)) {
  series_ = mechanics_->series();
  parameters_ = mechanics_->parameters();
  Eigen::VectorXd readings;
  if (!mechanics_->predict(truth, readings, nullptr))
    throw std::invalid_argument(name() + ": no equilibrium where the truth is to be");
  math::Random random(static_cast<std::uint64_t>(seed), "synthetic");
  Eigen::Index row = 0;
  for (fit::Series& series : series_) {
    for (Eigen::Index i = 0; i < series.measured.size(); ++i, ++row)
      series.measured[i] = readings[row] + series.deviation * random.normal();
  }
}

std::vector<Coverage> measure_coverage(std::shared_ptr<const fit::Experiment> mechanics,
                                       const Eigen::VectorXd& truth, int seeds,
                                       const std::function<void(double)>& progress) {
  std::vector<Coverage> rows;
  const std::vector<fit::Parameter>& parameters = mechanics->parameters();
  for (const fit::Parameter& p : parameters)
    if (p.lower < p.upper && p.name.find('.') == std::string::npos)
      rows.push_back({mechanics->name(), p.name});
  for (int seed = 1; seed <= seeds; ++seed) {
    fit::Problem problem({{std::make_shared<Synthetic>(mechanics, truth, seed), {}, {}}}, {});
    // The noise is as given for the series: eight rests are too few to estimate it.
    fit::FitOptions options;
    options.is_reweighed = false;
    const fit::Fit found = fit::fit_problem(problem, options, problem.start());
    for (Coverage& row : rows) {
      const fit::Estimate* estimate = found.find(row.parameter);
      if (estimate == nullptr || estimate->standing != fit::Standing::kEstimated) continue;
      std::size_t place = 0;
      while (parameters[place].name != row.parameter) ++place;
      const double value = truth[static_cast<Eigen::Index>(place)];
      ++row.seeds;
      if (estimate->interval[0] <= value && value <= estimate->interval[1]) ++row.covered;
      row.mean_width +=
          (estimate->interval[1] - estimate->interval[0]) / (value != 0 ? std::abs(value) : 1);
    }
    if (progress) progress(static_cast<double>(seed) / seeds);
  }
  for (Coverage& row : rows)
    if (row.seeds > 0) row.mean_width /= row.seeds;
  return rows;
}

}  // namespace palpate::fit_check
