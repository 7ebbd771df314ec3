#include "tools/fit/report.hpp"

#include <nlohmann/json.hpp>

namespace palpate::fit {
namespace {

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
  for (const int i : u.determined)
    json["determined"].push_back(u.estimates[static_cast<std::size_t>(i)].parameter.name);
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

}  // namespace palpate::fit
