#include "tools/fit/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "tools/common/table.hpp"

namespace palpate::fit {
namespace {

using common::formatted;
using common::number;
using common::Table;

nlohmann::json errors_json(const Errors& e) {
  return {{"samples", e.count}, {"median", e.median}, {"rmse", e.rmse}, {"percent", e.percent}};
}

nlohmann::json uncertainty_json(const Uncertainty& u) {
  nlohmann::json json;
  for (const Estimate& e : u.estimates) {
    nlohmann::json& one = json["parameters"][e.parameter.name];
    one = {{"unit", e.parameter.unit}, {"standing", name_of(e.standing)}, {"value", e.value}};
    if (e.standing != Standing::kEstimated) continue;
    one["deviation"] = e.deviation;
    one["interval"] = e.interval;
    one["by"] = derivation(e);
  }
  json["determined"] = nlohmann::json::array();
  for (const int i : u.determined) json["determined"].push_back(u.estimates[i].parameter.name);
  for (Eigen::Index i = 0; i < u.covariance.rows(); ++i) {
    json["covariance"].push_back(
        std::vector<double>(u.covariance.row(i).begin(), u.covariance.row(i).end()));
    json["correlation"].push_back(
        std::vector<double>(u.correlation.row(i).begin(), u.correlation.row(i).end()));
  }
  json["undetermined"] = nlohmann::json::array();
  for (const OpenDirection& open : u.open) {
    nlohmann::json shares;
    for (const auto& [name, share] : open.shares) shares[name] = share;
    json["undetermined"].push_back(shares);
  }
  return json;
}

nlohmann::json result_json(const Job& job, const JobResult& result) {
  nlohmann::json json = {{"fit", job.name}, {"group", job.group}, {"variant", job.variant}};
  if (!result.error.empty()) {
    json["error"] = result.error;
    return json;
  }
  json.update(uncertainty_json(result.fit.uncertainty));
  for (std::size_t s = 0; s < result.fit.series.size(); ++s) {
    const SeriesFit& f = result.fit.series[s];
    const SeriesNoise& noise = result.fit.uncertainty.noise[s];
    json["series"].push_back({{"recording", f.recording},
                              {"quantity", f.quantity},
                              {"unit", f.unit},
                              {"fitted", errors_json(f.fitted)},
                              {"held_out", errors_json(f.held_out)},
                              {"noise", noise.deviation},
                              {"autocorrelation_factor", noise.factor},
                              {"independent_samples", noise.effective}});
  }
  if (result.effective)
    json["corotational"] = {{"young_modulus", result.effective->young_modulus},
                            {"young_modulus_interval", result.effective->modulus_interval},
                            {"poisson_ratio", result.effective->poisson_ratio},
                            {"poisson_ratio_interval", result.effective->poisson_interval},
                            {"strain_range", result.effective->strain_range}};
  json["model"] = result.material;
  json["cost"] = result.fit.solution.cost;
  json["converged"] = result.fit.solution.is_converged;
  json["iterations"] = result.fit.solution.iterations;
  json["seconds"] = result.fit.seconds;
  json["evaluations"] = {{"predictions", result.fit.count.predictions},
                         {"with_derivatives", result.fit.count.jacobians}};
  return json;
}

void print_parameters(const Uncertainty& u, std::ostream& out) {
  Table table({"parameter", "value", "95 % interval", "by"});
  for (const Estimate& e : u.estimates) {
    const bool has_interval = e.standing == Standing::kEstimated;
    table.add({e.parameter.name,
               e.standing == Standing::kUndetermined ? "" : readable(e.value, e.parameter.unit),
               has_interval ? interval_text(e.interval, e.parameter.unit) : "", derivation(e)});
  }
  table.print(out);
}

void print_open(const Uncertainty& u, std::ostream& out) {
  for (const OpenDirection& open : u.open) {
    out << "The data do not determine";
    const char* separator = " ";
    for (const auto& [name, share] : open.shares) {
      out << separator << name;
      if (open.shares.size() > 1) out << " (" << formatted("%+.2f", share) << ")";
      separator = ", ";
    }
    out << (open.shares.size() > 1 ? ": they may change together by these shares"
                                   : ": anything allowed fits as well")
        << ".\n";
  }
}

void print_correlations(const Uncertainty& u, std::ostream& out) {
  constexpr double kWorthReporting = 0.9;
  for (std::size_t i = 0; i < u.determined.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double r = u.correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      if (std::abs(r) < kWorthReporting) continue;
      const auto name = [&](std::size_t k) { return u.estimates[u.determined[k]].parameter.name; };
      out << "Correlated by " << number(r, 3) << ": " << name(j) << ", " << name(i) << ".\n";
    }
}

void print_series(const JobResult& result, std::ostream& out) {
  Table table({"recording, quantity", "samples", "independent", "RMSE", "% of range", "held out",
               "median |error|", "RMSE", "% of range"});
  for (std::size_t s = 0; s < result.fit.series.size(); ++s) {
    const SeriesFit& f = result.fit.series[s];
    std::vector<std::string> row = {f.recording + ", " + f.quantity,
                                    std::to_string(f.fitted.count)};
    if (f.fitted.count > 0) {
      row.push_back(number(result.fit.uncertainty.noise[s].effective, 0));
      row.push_back(readable(f.fitted.rmse, f.unit));
      row.push_back(number(f.fitted.percent, 2));
    } else {
      row.insert(row.end(), 3, "");
    }
    if (f.held_out.count > 0) {
      row.push_back(std::to_string(f.held_out.count));
      row.push_back(readable(f.held_out.median, f.unit));
      row.push_back(readable(f.held_out.rmse, f.unit));
      row.push_back(number(f.held_out.percent, 2));
    }
    table.add(std::move(row));
  }
  table.print(out);
}

/// The member's own parameters, extracted from the problem's by their names there.
Eigen::VectorXd values_of(const Member& member, const std::map<std::string, double>& values) {
  const std::vector<Parameter>& wanted = member.experiment->parameters();
  const std::string prefix = member.experiment->name() + ".";
  Eigen::VectorXd result(static_cast<Eigen::Index>(wanted.size()));
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    auto found = values.find(prefix + wanted[k].name);  // shared elsewhere, own parameter here
    if (found == values.end()) found = values.find(wanted[k].name);
    if (found == values.end()) found = values.find(wanted[k].name.substr(prefix.size()));
    result[k] = found->second;
  }
  return result;
}

}  // namespace

nlohmann::json to_json(const Plan& plan, const std::vector<JobResult>& results) {
  nlohmann::json json = {{"plan", plan.name}, {"about", plan.about}};
  for (std::size_t k = 0; k < results.size(); ++k) {
    nlohmann::json one = result_json(plan.jobs[k], results[k]);
    for (const GradientCheck& check : results[k].gradients)
      one["gradients"].push_back({{"quantity", check.quantity},
                                  {"parameter", check.parameter},
                                  {"difference", check.difference}});
    if (results[k].numeric)
      one["numeric"] = {{"seconds", results[k].numeric->seconds_numeric},
                        {"evaluations", results[k].numeric->evaluations_numeric},
                        {"analytic_seconds", results[k].numeric->seconds},
                        {"analytic_evaluations", results[k].numeric->evaluations}};
    json["fits"].push_back(std::move(one));
  }
  return json;
}

std::string readable(double value, const std::string& unit) {
  if (unit.empty()) return formatted("%.4g", value);
  const double size = std::abs(value);
  // Compound units such as "m/s2" are printed without prefix: it would belong to their first letter
  // alone.
  const bool may_have_prefix =
      unit == "Pa" || unit == "N" || unit == "m" || unit == "s" || unit == "Pa s";
  if (may_have_prefix && size > 0) {
    if (size >= 1e6) return formatted("%.4g", value / 1e6) + " M" + unit;
    if (size >= 1e3) return formatted("%.4g", value / 1e3) + " k" + unit;
    if (size < 0.9e-3) return formatted("%.4g", value * 1e6) + " u" + unit;
    if (size < 0.9) return formatted("%.4g", value * 1e3) + " m" + unit;
  }
  return formatted("%.4g", value) + " " + unit;
}

std::string interval_text(const std::array<double, 2>& interval, const std::string& unit) {
  return readable(interval[0], unit) + " to " + readable(interval[1], unit);
}

std::string derivation(const Estimate& estimate) {
  if (estimate.standing != Standing::kEstimated) return name_of(estimate.standing);
  return estimate.is_profile ? "profile" : "curvature";
}

void print_details(const Job& job, const JobResult& result, std::ostream& out) {
  out << "\n" << job.title() << " (" << result.material << ")\n";
  if (!result.error.empty()) {
    out << "  " << result.error << "\n";
    return;
  }
  print_parameters(result.fit.uncertainty, out);
  print_open(result.fit.uncertainty, out);
  print_correlations(result.fit.uncertainty, out);
  out << "\n";
  print_series(result, out);
  if (result.effective) {
    const EffectiveMaterial& e = *result.effective;
    out << "\nCo-rotational: E " << readable(e.young_modulus, "Pa") << " ("
        << interval_text(e.modulus_interval, "Pa") << "), nu " << number(e.poisson_ratio, 3) << " ("
        << number(e.poisson_interval[0], 3) << " to " << number(e.poisson_interval[1], 3)
        << "), for strains from " << number(100 * e.strain_range[0], 1) << " to "
        << number(100 * e.strain_range[1], 1) << " %.\n";
  }
  out << "Evaluations: " << result.fit.count.predictions << " predictions, "
      << result.fit.count.jacobians << " with derivatives, in " << readable(result.fit.seconds, "s")
      << (result.fit.solution.is_converged ? "" : "; the search did NOT converge") << ".\n";
}

bool print_failures(const Plan& plan, const std::vector<JobResult>& results, std::ostream& out) {
  std::size_t many = 0, failed_of_many = 0, failed_alone = 0;
  std::string first;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const Job& job = plan.jobs[k];
    const std::string& error = results[k].error;
    many += job.is_one_of_many ? 1 : 0;
    if (error.empty()) continue;
    if (job.is_one_of_many) {
      if (failed_of_many++ == 0) first = job.title() + ": " + error;
    } else {
      ++failed_alone;
      out << "palpate-fit: " << job.title() << ": " << error << "\n";
    }
  }
  if (failed_of_many > 0)
    out << failed_of_many << " of " << many << " fits have no result; the first: " << first << "\n";
  return failed_alone == 0 && 10 * failed_of_many <= many;
}

bool print_gradients(const std::vector<JobResult>& results, std::ostream& out) {
  std::map<std::string, GradientCheck> worst;
  for (const JobResult& result : results)
    for (const GradientCheck& check : result.gradients) {
      GradientCheck& most = worst.try_emplace(check.quantity, check).first->second;
      if (check.difference > most.difference) most = check;
    }
  Table table({"residual", "largest relative difference", "of"});
  bool is_good = true;
  for (const auto& [quantity, check] : worst) {
    table.add({quantity, formatted("%.1e", check.difference), check.parameter});
    is_good = is_good && check.difference <= kGradientTolerance;
  }
  out << "\nDerivatives against Ridders' differences, at start and result:\n";
  table.print(out);
  if (!is_good) out << "above " << formatted("%.0e", kGradientTolerance) << "\n";
  return is_good;
}

void print_comparison(const std::vector<JobResult>& results, std::ostream& out) {
  NumericComparison sum;
  for (const JobResult& result : results) {
    if (!result.numeric) continue;
    sum.seconds += result.numeric->seconds;
    sum.seconds_numeric += result.numeric->seconds_numeric;
    sum.evaluations += result.numeric->evaluations;
    sum.evaluations_numeric += result.numeric->evaluations_numeric;
    sum.difference = std::max(sum.difference, result.numeric->difference);
  }
  if (sum.evaluations == 0 || !(sum.seconds > 0)) return;
  out << "\nNumeric differentiation against analytic: "
      << formatted("%.1f", static_cast<double>(sum.evaluations_numeric) /
                               static_cast<double>(sum.evaluations))
      << " times the evaluations (" << sum.evaluations_numeric << " / " << sum.evaluations << "), "
      << formatted("%.1f", sum.seconds_numeric / sum.seconds) << " times the time ("
      << readable(sum.seconds_numeric, "s") << " / " << readable(sum.seconds, "s")
      << "); costs differ by at most " << formatted("%.1e", sum.difference) << ".\n";
}

void print_findings(const Job& job, const JobResult& result, std::ostream& out) {
  if (!result.error.empty()) return;
  const Problem& problem = *result.problem;
  const Eigen::VectorXd all = problem.values(result.fit.solution.coordinates);
  std::map<std::string, double> values;
  for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
    values[problem.parameters()[p].name] = all[p];
  }
  common::Table table({job.title(), "quantity", "measured", "predicted", "difference", "goal", ""});
  bool is_empty = true;
  for (const Member& member : problem.members()) {
    for (const Finding& f : member.experiment->findings(values_of(member, values))) {
      const double difference = f.predicted - f.measured;
      const bool is_met = f.is_bound ? difference < 0 : std::abs(difference) <= f.allowed;
      table.add({member.experiment->name(), f.what, readable(f.measured, f.unit),
                 readable(f.predicted, f.unit), readable(difference, f.unit),
                 f.is_bound      ? "less"
                 : f.allowed > 0 ? readable(f.allowed, f.unit)
                                 : "",
                 f.is_bound || f.allowed > 0 ? (is_met ? "met" : "MISSED") : ""});
      is_empty = false;
    }
  }
  if (is_empty) return;
  out << "\n";
  table.print(out);
}

}  // namespace palpate::fit
