#include "tools/fit/report.hpp"

#include <cctype>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/common/output_files.hpp"
#include "tools/common/process.hpp"
#include "tools/common/table.hpp"

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
    json["order"].push_back(e.parameter.name);
    if (e.standing != Standing::kEstimated) continue;
    one["deviation"] = e.deviation;
    one["interval"] = e.interval;
    one["by"] = e.is_profile ? "profile" : "curvature";
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

/// A series: its samples in the recorded order, and their errors.
nlohmann::json series_json(const JobResult& result, std::size_t s) {
  const Series& series = result.problem->series_at(s);
  const SeriesFit& f = result.fit.series[s];
  const SeriesNoise& noise = result.fit.uncertainty.noise[s];
  nlohmann::json json = {{"recording", f.recording},
                         {"quantity", f.quantity},
                         {"unit", f.unit},
                         {"abscissa", series.abscissa},
                         {"abscissa_unit", series.abscissa_unit},
                         {"fitted", errors_json(f.fitted)},
                         {"held_out", errors_json(f.held_out)},
                         {"noise", noise.deviation},
                         {"autocorrelation_factor", noise.factor},
                         {"independent_samples", noise.effective}};
  nlohmann::json& samples = json["samples"];
  for (Eigen::Index i = 0; i < series.measured.size(); ++i) {
    samples["x"].push_back(abscissa_of(series, i));
    samples["measured"].push_back(series.measured[i]);
    samples["predicted"].push_back(f.predicted[i]);
    samples["held_out"].push_back(!result.problem->is_fitted(s, i));
  }
  return json;
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

/// Results of the experiments in addition to their residuals (Experiment::findings).
nlohmann::json findings_json(const JobResult& result) {
  const Problem& problem = *result.problem;
  const Eigen::VectorXd all = problem.values(result.fit.solution.coordinates);
  std::map<std::string, double> values;
  for (std::size_t p = 0; p < problem.parameters().size(); ++p)
    values[problem.parameters()[p].name] = all[p];
  nlohmann::json json = nlohmann::json::array();
  for (const Member& member : problem.members())
    for (const Finding& f : member.experiment->findings(values_of(member, values)))
      json.push_back({{"recording", member.experiment->name()},
                      {"what", f.what},
                      {"unit", f.unit},
                      {"measured", f.measured},
                      {"predicted", f.predicted},
                      {"allowed", f.allowed},
                      {"is_bound", f.is_bound}});
  return json;
}

nlohmann::json result_json(const Job& job, const JobResult& result) {
  nlohmann::json json = {
      {"fit", job.name}, {"title", job.title()}, {"group", job.group}, {"variant", job.variant}};
  if (!result.error.empty()) {
    json["error"] = result.error;
    return json;
  }
  json.update(uncertainty_json(result.fit.uncertainty));
  for (std::size_t s = 0; s < result.fit.series.size(); ++s)
    json["series"].push_back(series_json(result, s));
  json["findings"] = findings_json(result);
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

std::string exact(double value) { return common::formatted("%.9g", value); }

std::string pair_text(const std::array<double, 2>& pair) {
  return "[" + exact(pair[0]) + ", " + exact(pair[1]) + "]";
}

bool has_folder(const std::vector<JobResult>& results, std::size_t k) {
  constexpr std::size_t kMostFolders = 200;
  return results[k].error.empty() && results.size() <= kMostFolders;
}

/// Name of a fit's folder below that of the plan; none if there is one fit.
std::string folder_of(const Plan& plan, std::size_t k) {
  if (plan.jobs.size() == 1) return "";
  std::string name;
  for (const char c : plan.jobs[k].title())
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' ? c : '_';
  return name;
}

/// Whether it is a parameter of the material, not a recording's own.
bool is_material(const Estimate& e) { return e.parameter.name.find('.') == std::string::npos; }

}  // namespace

nlohmann::json to_json(const Plan& plan, const std::vector<JobResult>& results) {
  nlohmann::json json = {
      {"plan", plan.name}, {"about", plan.about}, {"gradient_tolerance", kGradientTolerance}};
  for (std::size_t k = 0; k < results.size(); ++k) {
    nlohmann::json one = result_json(plan.jobs[k], results[k]);
    if (has_folder(results, k)) one["folder"] = folder_of(plan, k);
    for (const GradientCheck& check : results[k].gradients)
      one["gradients"].push_back({{"quantity", check.quantity},
                                  {"parameter", check.parameter},
                                  {"difference", check.difference}});
    if (results[k].numeric)
      one["numeric"] = {{"seconds", results[k].numeric->seconds_numeric},
                        {"evaluations", results[k].numeric->evaluations_numeric},
                        {"difference", results[k].numeric->difference},
                        {"analytic_seconds", results[k].numeric->seconds},
                        {"analytic_evaluations", results[k].numeric->evaluations}};
    json["fits"].push_back(std::move(one));
  }
  return json;
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

bool has_wrong_gradient(const std::vector<JobResult>& results) {
  for (const JobResult& result : results)
    for (const GradientCheck& check : result.gradients)
      if (!(check.difference <= kGradientTolerance)) return true;
  return false;
}

void write_material(const Job& job, const JobResult& result, std::ostream& out) {
  const Uncertainty& u = result.fit.uncertainty;
  out << "# " << job.title() << ": a material as palpate-fit found it; SI units.\nmaterial:\n"
      << "  model: " << result.material << "\n";
  const auto is_known = [](const Estimate& e) {
    return is_material(e) && e.standing != Standing::kUndetermined;
  };
  for (const Estimate& e : u.estimates)
    if (is_known(e))
      out << "  " << e.parameter.name << ": " << exact(e.value)
          << (e.standing == Standing::kAtBound ? "  # at the bound of what was allowed"
              : e.standing == Standing::kKnown ? "  # given, not fitted"
                                               : "")
          << "\n";
  out << "intervals:  # 95 %\n";
  for (const Estimate& e : u.estimates)
    if (is_known(e) && e.standing == Standing::kEstimated)
      out << "  " << e.parameter.name << ": " << pair_text(e.interval) << "\n";
  out << "undetermined: [";
  const char* separator = "";
  for (const Estimate& e : u.estimates)
    if (e.standing == Standing::kUndetermined) {
      out << separator << e.parameter.name;
      separator = ", ";
    }
  out << "]\n";
  if (!result.effective) return;
  const EffectiveMaterial& e = *result.effective;
  out << "corotational:  # for palpated's linear model\n  young_modulus: " << exact(e.young_modulus)
      << "\n  poisson_ratio: " << exact(e.poisson_ratio)
      << "\n  strain_range: " << pair_text(e.strain_range)
      << "\n  intervals: {young_modulus: " << pair_text(e.modulus_interval)
      << ", poisson_ratio: " << pair_text(e.poisson_interval) << "}\n";
}

void write_materials(const Plan& plan, const std::vector<JobResult>& results,
                     const std::filesystem::path& folder) {
  for (std::size_t k = 0; k < results.size(); ++k) {
    if (!has_folder(results, k)) continue;
    const std::filesystem::path own = folder / folder_of(plan, k);
    std::filesystem::create_directories(own);
    std::ofstream out(own / "material.yaml");
    write_material(plan.jobs[k], results[k], out);
    if (!out.flush()) throw std::runtime_error("cannot write " + (own / "material.yaml").string());
  }
}

std::string make_report(const nlohmann::json& json, const std::filesystem::path& folder,
                        bool details) {
  const common::TemporaryFolder temporary("palpate-fit");
  const std::filesystem::path file = (folder.empty() ? temporary.path() : folder) / "fits.json";
  common::write_json(json, file);
  std::vector<std::string> arguments{file.string()};
  if (!folder.empty()) arguments.emplace_back("--files");
  if (details) arguments.emplace_back("--details");
  return common::run_python("tools/fit/report_fits.py", arguments);
}

}  // namespace palpate::fit
