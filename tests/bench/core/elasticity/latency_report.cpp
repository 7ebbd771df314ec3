#include "tests/bench/core/elasticity/latency_report.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "tools/common/table.hpp"

namespace palpate::bench {
namespace {

using common::number;

std::string scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

/// With a mark if it could not be computed for some steps.
std::string error_text(const LatencyResult& r) {
  if (r.checks == 0) return "";
  return r.unknown == 0 ? scientific(r.error)
                        : scientific(r.error) + " -" + std::to_string(r.unknown);
}

std::string ms(double seconds) { return number(1e3 * seconds, seconds < 0.01 ? 3 : 1); }
std::string ratio(double a, double b) { return b > 0 ? number(a / b, 1) : ""; }

int threads_of(const LatencyOptions& options) {
  return options.solver.team != nullptr ? options.solver.team->size() : 1;
}

nlohmann::json quantiles(const Samples& s) {
  return {{"min", s.quantile(0)},       {"p50", s.quantile(0.5)}, {"p99", s.quantile(0.99)},
          {"p99.9", s.quantile(0.999)}, {"max", s.max()},         {"mean", s.mean()},
          {"count", s.count()}};
}

nlohmann::json baseline_json(const BaselineResult& b, const LatencyResult& r) {
  return {{"wall_s", quantiles(b.times.wall)},
          {"thread_s", quantiles(b.times.cpu)},
          {"assembly_s", quantiles(b.assembly)},
          {"linear_iterations", quantiles(b.iterations)},
          {"error", b.error},
          {"failed", b.failed},
          {"ratio_p50", b.times.wall.quantile(0.5) / r.step.wall.quantile(0.5)},
          {"ratio_thread_p50", b.times.cpu.quantile(0.5) / r.step.cpu.quantile(0.5)}};
}

void add_baseline(common::Table& table, const char* name, const BaselineResult& b,
                  const LatencyResult& r) {
  if (b.times.wall.count() == 0) return;
  table.add({std::string("  ") + name, "", "", number(b.iterations.mean(), 1),
             ms(b.times.wall.quantile(0)), ms(b.times.wall.quantile(0.5)),
             ms(b.times.wall.quantile(0.99)), ms(b.times.wall.quantile(0.999)),
             ms(b.times.wall.max()), ms(b.times.cpu.quantile(0.5)), ms(b.times.cpu.quantile(0.99)),
             scientific(b.error), b.failed > 0 ? std::to_string(b.failed) : "", "", "", "",
             ratio(b.times.wall.quantile(0.5), r.step.wall.quantile(0.5)),
             ratio(b.times.cpu.quantile(0.5), r.step.cpu.quantile(0.5))});
}

}  // namespace

void print_latency(const std::vector<LatencyRow>& rows, std::ostream& out) {
  common::Table table({"mesh", "motion", "threads", "its", "min", "p50", "p99", "p99.9", "max",
                       "cpu50", "cpu99", "error", "failed", "factors", "factor ms", "age", "x wall",
                       "x cpu"});
  for (const LatencyRow& row : rows) {
    const LatencyResult& r = row.result;
    const bool dynamic = row.options.mechanics == Mechanics::kDynamic;
    table.add({row.options.mesh.text() + (row.options.law.empty() ? "" : " " + row.options.law),
               letter_of(row.options.motion) + (dynamic ? " dyn" : " stat"),
               std::to_string(threads_of(row.options)), number(r.iterations.mean(), 2),
               ms(r.step.wall.quantile(0)), ms(r.step.wall.quantile(0.5)),
               ms(r.step.wall.quantile(0.99)), ms(r.step.wall.quantile(0.999)),
               ms(r.step.wall.max()), ms(r.step.cpu.quantile(0.5)), ms(r.step.cpu.quantile(0.99)),
               error_text(r), std::to_string(r.failed), std::to_string(r.refactorisations),
               ms(r.refactor_wall.quantile(0.5)), number(1e3 * r.factor_age.quantile(0.5), 0), "",
               ""});
    add_baseline(table, "full CHOLMOD", r.cholmod, r);
    add_baseline(table, "Jacobi-PCG", r.pcg, r);
  }
  table.print(out);
}

nlohmann::json to_json(const LatencyRow& row) {
  const LatencyOptions& o = row.options;
  const LatencyResult& r = row.result;
  nlohmann::json json{
      {"element", o.mesh.order == mesh::ElementOrder::kLinear ? "linear" : "quadratic"},
      {"nodes", o.mesh.node_count()},
      {"cells", o.mesh.cells},
      {"motion", letter_of(o.motion)},
      {"mechanics", o.mechanics == Mechanics::kDynamic ? "dynamic" : "quasistatic"},
      {"young_modulus", o.young_modulus},
      {"law", o.law.empty() ? "linear" : o.law},
      {"threads", threads_of(o)},
      {"iterations", o.solver.iterations},
      {"tolerance", o.solver.tolerance},
      {"refactor", o.refactor.text()},
      {"paced", o.paced},
      {"dt", o.dt},
      {"wall_s", quantiles(r.step.wall)},
      {"thread_s", quantiles(r.step.cpu)},
      {"iterations_taken", quantiles(r.iterations)},
      {"not_converged", r.not_converged},
      {"failed", r.failed},
      {"error", r.error},
      {"amplitude", r.amplitude},
      {"checks", r.checks},
      {"checks_without_converged_solve", r.unknown},
      {"refactorisations", r.refactorisations},
      {"refactor_wall_s", quantiles(r.refactor_wall)},
      {"refactor_thread_s", quantiles(r.refactor_cpu)},
      {"factor_age_s", quantiles(r.factor_age)},
      {"sensitivity_age_s", quantiles(r.sensitivity_age)}};
  if (o.baselines) {
    json["cholmod"] = baseline_json(r.cholmod, r);
    json["jacobi_pcg"] = baseline_json(r.pcg, r);
  }
  return json;
}

}  // namespace palpate::bench
