#include "tools/lab/cases/case_report.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "tools/common/table.hpp"

namespace palpate::cases {
namespace {

using nlohmann::json;

std::string scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

json list(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

void add(json& to, const char* key, const std::optional<double>& value) {
  if (value) to[key] = *value;
}

json to_json(const CaseFigures& figures) {
  json j{{"probe_rms_error_m", figures.probe_rms},
         {"probe_max_error_m", figures.probe_max},
         {"probe_rms_error_over_max_u", figures.rms_share()},
         {"probe_max_error_over_max_u", figures.max_share()},
         {"largest_reference_displacement_m", figures.largest_reference},
         {"probe_outside_m", figures.outside}};
  if (figures.mean) j["mean_displacement_load_face"] = list(*figures.mean);
  add(j, "twist_deg", figures.twist_deg);
  if (figures.grasp) {
    j["grasp_force"] = list(figures.grasp->force);
    j["grasp_moment_about_moved_centre"] = list(figures.grasp->torque);
  }
  if (figures.fixed) {
    j["fixed_force"] = list(figures.fixed->force);
    j["fixed_moment_about_origin"] = list(figures.fixed->torque);
  }
  return j;
}

void add_times(json& j, const StepTimes& times) {
  j["iterations"] = times.iterations;
  j["iterations_max"] = times.most_iterations;
  j["step_p50_us"] = times.p50;
  j["step_p99_us"] = times.p99;
  j["ticks"] = times.ticks;
  j["refactorisations"] = times.refactorisations;
}

json to_json(const BaselineDifference& difference) {
  json j{{"probe_rms_error_over_max_u", difference.rms_share},
         {"probe_max_error_over_max_u", difference.max_share}};
  add(j, "mean_relative", difference.mean);
  add(j, "twist_relative", difference.twist);
  add(j, "force_relative", difference.force);
  add(j, "moment_relative", difference.moment);
  return j;
}

std::string monitored(const CaseFigures& figures) {
  if (figures.twist_deg) return common::number(*figures.twist_deg, 3) + " deg";
  if (figures.grasp) return common::number(figures.grasp->force.norm(), 4) + " N";
  return figures.mean ? common::number(1e3 * figures.mean->norm(), 3) + " mm" : "";
}

}  // namespace

const char* name_of(mesh::ElementOrder order) {
  return order == mesh::ElementOrder::kLinear ? "linear" : "quadratic";
}

void print_cases(const std::vector<CaseScore>& scores, std::ostream& out) {
  const bool dynamic = std::any_of(scores.begin(), scores.end(),
                                   [](const CaseScore& s) { return s.dynamic.has_value(); });
  std::vector<std::string> header{"mesh",   "element",    "nodes",   "tets",    "RMS %",
                                  "max %",  "monitored",  "Newton",  "it/tick", "p50 us",
                                  "p99 us", "off stored", "relative"};
  if (dynamic) header.insert(header.end(), {"settled s", "damping 1/s", "RMS %", "from static"});
  common::Table table(header);
  std::string name;
  for (const CaseScore& score : scores) {
    if (score.name != name) table.section(name = score.name);
    std::vector<std::string> row{score.mesh,
                                 name_of(score.order),
                                 std::to_string(score.nodes),
                                 std::to_string(score.elements),
                                 common::number(100 * score.figures.rms_share(), 3),
                                 common::number(100 * score.figures.max_share(), 3),
                                 monitored(score.figures),
                                 std::to_string(score.equilibrium.iterations)};
    const StepTimes* times = score.dynamic       ? &score.dynamic->times
                             : score.incremental ? &score.incremental->times
                                                 : nullptr;
    for (const double value :
         {times ? times->iterations : 0.0, times ? times->p50 : 0.0, times ? times->p99 : 0.0})
      row.push_back(times ? common::number(value, 1) : "");
    if (score.baseline) {
      const BaselineDifference difference = compare(score.figures, *score.baseline);
      row.push_back(scientific(difference.largest_share()));
      row.push_back(scientific(difference.largest_relative()));
    } else {
      row.resize(row.size() + 2);
    }
    if (score.dynamic) {
      row.push_back(score.dynamic->at_rest ? common::number(score.dynamic->settling_time, 3)
                                           : "not at rest");
      row.push_back(common::number(score.dynamic->mass_damping, 1));
      row.push_back(common::number(100 * score.dynamic_figures->rms_share(), 3));
      row.push_back(scientific(score.dynamic->deviation / score.figures.largest_reference));
    }
    table.add(row);
  }
  table.print(out);
  out << "Errors at the reference's probes in % of its largest displacement; step times on one "
         "thread, per 1 ms\ntick. Off stored: error norms against the stored solution on the same "
         "file, absolute; relative: the\nlargest relative difference of mean displacement, twist, "
         "force and moment from it.\n";
  for (const CaseScore& score : scores) {
    if (score.converged()) continue;
    out << "NOT CONVERGED: " << score.name << ' ' << score.mesh << ' ' << name_of(score.order)
        << ": ";
    if (!score.equilibrium.converged)
      out << "Newton's method, residual " << scientific(score.equilibrium.residual) << " N\n";
    else
      out << (score.dynamic ? "the dynamic model is not at rest\n" : "the incremental model\n");
  }
}

json to_json(const CaseScore& score) {
  json equilibrium = to_json(score.figures);
  equilibrium["newton_iterations"] = score.equilibrium.iterations;
  equilibrium["load_steps"] = score.equilibrium.load_steps;
  equilibrium["residual_N"] = score.equilibrium.residual;
  json j;
  if (score.dynamic) {
    j = to_json(*score.dynamic_figures);
    add_times(j, score.dynamic->times);
    j["settling_time_s"] = score.dynamic->settling_time;
    j["at_rest"] = score.dynamic->at_rest;
    j["simulated_s"] = score.dynamic->seconds;
    j["mass_damping"] = score.dynamic->mass_damping;
    j["deviation_from_static_m"] = score.dynamic->deviation;
    j["static"] = equilibrium;
  } else {
    j = equilibrium;
    if (score.incremental) {
      add_times(j, score.incremental->times);
      j["incremental_deviation_m"] = score.incremental->deviation;
    }
  }
  j["case"] = score.name;
  j["mesh"] = score.mesh;
  j["element"] = name_of(score.order);
  j["nodes"] = score.nodes;
  j["elements"] = score.elements;
  j["converged"] = score.converged();
  if (score.baseline) {
    j["baseline_on_delivered_meshes"] = *score.baseline;
    j["difference_from_baseline"] =
        to_json(compare(score.dynamic ? *score.dynamic_figures : score.figures, *score.baseline));
  }
  return j;
}

}  // namespace palpate::cases
