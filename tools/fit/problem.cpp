#include "tools/fit/problem.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::fit {
namespace {

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Name of a member's parameter in the problem.
std::string name_in_problem(const Member& member, const std::string& name) {
  const std::string prefix = member.experiment->name() + ".";
  if (holds(member.own, name)) return prefix + name;
  if (name.rfind(prefix, 0) == 0 && holds(member.shared, name.substr(prefix.size())))
    return name.substr(prefix.size());
  return name;
}

bool is_known(const Parameter& parameter) { return parameter.lower == parameter.upper; }

}  // namespace

Problem::Problem(std::vector<Member> members, const std::map<std::string, ParameterChange>& changes)
    : members_(std::move(members)) {
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const Experiment& experiment = *members_[m].experiment;
    places_.emplace_back();
    for (Parameter parameter : experiment.parameters()) {
      parameter.name = name_in_problem(members_[m], parameter.name);
      add_parameter(parameter);
      places_.back().push_back(static_cast<int>(find(parameter.name) - parameters_.begin()));
    }
    Eigen::Index row = 0;
    for (std::size_t s = 0; s < experiment.series().size(); ++s) {
      const Series& series = experiment.series()[s];
      series_.push_back({static_cast<int>(m), static_cast<int>(s), row});
      row += series.measured.size();
      deviations_.push_back(series.deviation);
      const auto held = std::count(series.is_held_out.begin(), series.is_held_out.end(), true);
      fitted_.push_back(series.measured.size() - held);
    }
  }
  change(changes);
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    if (!is_known(parameters_[i])) free_.push_back(static_cast<int>(i));
  if (free_.empty()) throw std::invalid_argument("every parameter is known: nothing to seek");
  if (fitted_count() == 0) throw std::invalid_argument("every sample is held out: nothing to fit");
}

std::vector<Parameter>::iterator Problem::find(const std::string& name) {
  return std::find_if(parameters_.begin(), parameters_.end(),
                      [&name](const Parameter& p) { return p.name == name; });
}

void Problem::add_parameter(const Parameter& parameter) {
  if (!std::isfinite(parameter.lower) || !std::isfinite(parameter.upper))
    throw std::invalid_argument(parameter.name + ": needs finite bounds");
  const auto found = find(parameter.name);
  if (found == parameters_.end()) {
    parameters_.push_back(parameter);
    return;
  }
  if (found->unit != parameter.unit || found->is_logarithmic != parameter.is_logarithmic)
    throw std::invalid_argument(parameter.name +
                                ": recordings that share it mean different things");
  found->lower = std::max(found->lower, parameter.lower);
  found->upper = std::min(found->upper, parameter.upper);
  if (found->lower > found->upper)
    throw std::invalid_argument(parameter.name +
                                ": what recordings that share it allow has nothing in common");
  found->start = std::clamp(found->start, found->lower, found->upper);
}

void Problem::change(const std::map<std::string, ParameterChange>& changes) {
  for (const auto& [name, to] : changes) {
    const auto found = find(name);
    if (found == parameters_.end()) {
      std::string all;
      for (const Parameter& p : parameters_) all += (all.empty() ? "" : ", ") + p.name;
      throw std::invalid_argument("no parameter '" + name + "'; there are " + all);
    }
    if (to.lower) found->lower = *to.lower;
    if (to.upper) found->upper = *to.upper;
    if (to.start) found->start = *to.start;
    if (to.known) found->start = found->lower = found->upper = *to.known;
    if (found->lower > found->upper || (found->is_logarithmic && !(found->lower > 0)))
      throw std::invalid_argument(name +
                                  ": lower must not be above upper, and above 0 where the "
                                  "parameter is positive");
    found->start = std::clamp(found->start, found->lower, found->upper);
  }
}

const Series& Problem::series_at(std::size_t place) const {
  const SeriesPlace& at = series_[place];
  return members_[at.member].experiment->series()[at.series];
}

bool Problem::is_fitted(std::size_t place, Eigen::Index sample) const {
  const std::vector<bool>& held = series_at(place).is_held_out;
  return held.empty() || !held[sample];
}

Eigen::Index Problem::fitted_count() const {
  Eigen::Index count = 0;
  for (const Eigen::Index n : fitted_) count += n;
  return count;
}

double Problem::to_coordinate(int parameter, double value) const {
  const Parameter& p = parameters_[parameter];
  return p.is_logarithmic ? std::log(value) : 2 * value / (p.upper - p.lower);
}

double Problem::to_value(int parameter, double coordinate) const {
  const Parameter& p = parameters_[parameter];
  const double value =
      p.is_logarithmic ? std::exp(coordinate) : coordinate * (p.upper - p.lower) / 2;
  return std::clamp(value, p.lower, p.upper);
}

double Problem::slope(int parameter, double value) const {
  const Parameter& p = parameters_[parameter];
  return p.is_logarithmic ? value : (p.upper - p.lower) / 2;
}

Eigen::VectorXd Problem::coordinates(double Parameter::*value) const {
  Eigen::VectorXd x(free_.size());
  for (std::size_t i = 0; i < free_.size(); ++i)
    x[i] = to_coordinate(free_[i], parameters_[free_[i]].*value);
  return x;
}

Eigen::VectorXd Problem::values(const Eigen::VectorXd& coordinates) const {
  Eigen::VectorXd all(parameters_.size());
  for (std::size_t i = 0; i < parameters_.size(); ++i) all[i] = parameters_[i].start;
  for (std::size_t i = 0; i < free_.size(); ++i) all[free_[i]] = to_value(free_[i], coordinates[i]);
  return all;
}

bool Problem::ask(int member, const Eigen::VectorXd& values, Eigen::VectorXd& prediction,
                  Eigen::MatrixXd* jacobian) const {
  const std::vector<int>& places = places_[member];
  Eigen::VectorXd ours(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) ours[k] = values[places[k]];
  ++(jacobian ? jacobians_ : predictions_);
  return members_[member].experiment->predict(ours, prediction, jacobian) && prediction.allFinite();
}

bool Problem::differentiate(int member, const Eigen::VectorXd& coordinates,
                            Eigen::MatrixXd& jacobian) const {
  constexpr double kStep = 1e-5;
  const Eigen::VectorXd least = lower(), most = upper();
  Eigen::VectorXd x = coordinates, above, below;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double high = std::min(x[i] + kStep, most[i]), low = std::max(x[i] - kStep, least[i]);
    x[i] = high;
    if (!ask(member, values(x), above, nullptr)) return false;
    x[i] = low;
    if (!ask(member, values(x), below, nullptr)) return false;
    x[i] = coordinates[i];
    jacobian.col(i) = (above - below) / (high - low);
  }
  return true;
}

bool Problem::predict(int member, const Eigen::VectorXd& coordinates, Eigen::VectorXd& prediction,
                      Eigen::MatrixXd* jacobian) const {
  const Eigen::VectorXd all = values(coordinates);
  if (!jacobian) return ask(member, all, prediction, nullptr);
  if (is_numeric) {
    if (!ask(member, all, prediction, nullptr)) return false;
    jacobian->setZero(prediction.size(), coordinates.size());
    return differentiate(member, coordinates, *jacobian);
  }
  Eigen::MatrixXd ours;
  if (!ask(member, all, prediction, &ours) || !ours.allFinite()) return false;
  jacobian->setZero(prediction.size(), coordinates.size());
  const std::vector<int>& places = places_[member];
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto found = std::find(free_.begin(), free_.end(), places[k]);
    if (found == free_.end()) continue;
    jacobian->col(found - free_.begin()) +=
        slope(places[k], all[places[k]]) * ours.col(static_cast<Eigen::Index>(k));
  }
  return true;
}

Eigen::Index Problem::residual_count(int member) const {
  Eigen::Index count = 0;
  for (std::size_t s = 0; s < series_.size(); ++s)
    if (series_[s].member == member) count += fitted_[s];
  return count;
}

bool Problem::residuals(int member, const Eigen::VectorXd& coordinates, Eigen::VectorXd& residuals,
                        Eigen::MatrixXd* jacobian) const {
  Eigen::VectorXd prediction;
  Eigen::MatrixXd by_coordinates;
  if (!predict(member, coordinates, prediction, jacobian ? &by_coordinates : nullptr)) return false;
  residuals.resize(residual_count(member));
  if (jacobian) jacobian->resize(residuals.size(), coordinates.size());
  Eigen::Index row = 0;
  for (std::size_t s = 0; s < series_.size(); ++s) {
    if (series_[s].member != member) continue;
    const Series& series = series_at(s);
    for (Eigen::Index i = 0; i < series.measured.size(); ++i) {
      if (!is_fitted(s, i)) continue;
      const Eigen::Index from = series_[s].row + i;
      residuals[row] = (prediction[from] - series.measured[i]) / deviations_[s];
      if (jacobian) jacobian->row(row) = by_coordinates.row(from) / deviations_[s];
      ++row;
    }
  }
  return true;
}

}  // namespace palpate::fit
