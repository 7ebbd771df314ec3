#include <CLI/CLI.hpp>
#include <future>
#include <iostream>
#include <nlohmann/json.hpp>

#include "rt/config/command_line.hpp"
#include "rt/loop/real_time.hpp"
#include "rt/loop/spin_team.hpp"
#include "tests/bench/core/elasticity/factor_choice.hpp"
#include "tests/bench/core/elasticity/floor_report.hpp"
#include "tests/bench/core/elasticity/latency_report.hpp"
#include "tests/bench/core/elasticity/latency_suite.hpp"
#include "tools/common/output_files.hpp"

namespace palpate::bench {
namespace {

struct Arguments {
  LatencyOptions options;
  std::string element = "quadratic", motion = "L", mechanics = "dynamic", refactor = "background";
  std::string factor = "own";
  std::string json, plot = "scaling.png";
  int nodes = 475;
  std::vector<int> cells;
  bool suite = false, scaling = false, floor = false;
  int fifo = 0, cpu = -1, threads = 1;
};

void add_options(CLI::App& app, Arguments& a) {
  app.add_option("--element", a.element, "linear or quadratic")
      ->check(CLI::IsMember({"linear", "quadratic"}))
      ->capture_default_str();
  app.add_option("--nodes", a.nodes,
                 "one of linear 304 500 1008 2048 2997 9996, quadratic 225 475 625 725 1225 2673")
      ->capture_default_str();
  app.add_option("--cells", a.cells, "instead of --nodes: cells along x,y,z, each six tetrahedra")
      ->expected(3)
      ->delimiter(',');
  app.add_option("--motion", a.motion, "S: 0.1 N at the tip; L: 1 N turning, clamp swings; B: 2 N")
      ->check(CLI::IsMember({"S", "L", "B"}))
      ->capture_default_str();
  app.add_option("--mechanics", a.mechanics, "dynamic or quasistatic")
      ->check(CLI::IsMember({"dynamic", "quasistatic"}))
      ->capture_default_str();
  app.add_option("--young-modulus", a.options.young_modulus, "Pa; forces scale with it")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  std::vector<std::string> laws;
  for (const auto& law : elasticity::stretch_laws()) laws.push_back(law.name);
  app.add_option("--law", a.options.law,
                 "hyperelastic, with plausible constants; without checks and baselines, which know "
                 "the linear law")
      ->check(CLI::IsMember(laws));
  app.add_option("--iterations", a.options.solver.iterations, "corrections per step at most")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--refine", a.options.solver.refine,
                 "quasistatic: columns of the sensitivity corrected in each step")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_flag("!--no-confirm", a.options.solver.confirm,
               "No evaluation after the last correction");
  app.add_option("--accuracy", a.options.solver.accuracy,
                 "m, a step ends early where the next correction would move no node further")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  const std::map<std::string, elasticity::Precision> precisions{
      {"single", elasticity::Precision::kSingle}, {"double", elasticity::Precision::kDouble}};
  app.add_option("--precision", a.options.solver.precision, "of the arithmetic inside elements")
      ->transform(CLI::CheckedTransformer(precisions));
  const std::map<std::string, factor::PanelPrecision> panels{
      {"single", factor::PanelPrecision::kSingle}, {"half", factor::PanelPrecision::kHalf}};
  app.add_option("--panels", a.options.solver.panels, "of the factor")
      ->transform(CLI::CheckedTransformer(panels));
  app.add_option("--factor", a.factor, "computed in the background by: own or cholmod")
      ->capture_default_str();
  app.add_option("--tolerance", a.options.solver.tolerance,
                 "N, residual at which a step ends early")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--steps", a.options.steps, "steps to sample")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--warm-up", a.options.warm_up, "steps before the first sample")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--seconds", a.options.seconds, "wall time at most, per configuration");
  app.add_option("--checks", a.options.checks,
                 "steps compared with a converged solve (and timed baselines); 0: none")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--refactor", a.refactor,
                 "background (the daemon's thread), every-N (installed N steps after its snapshot; "
                 "repeatable), never")
      ->capture_default_str();
  app.add_flag(
      "--baseline", a.options.baselines,
      "time full CHOLMOD refactorisation and Jacobi-PCG as baselines, from the same states");
  app.add_flag("--paced", a.options.paced, "a step every millisecond, as in the daemon");
  app.add_option("--threads", a.threads, "that share a step, the stepping thread among them")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  app.add_option("--fifo", a.fifo, "SCHED_FIFO priority of these threads")
      ->check(CLI::Range(1, 99));
  app.add_option("--cpu", a.cpu, "processor of the stepping thread")->check(CLI::NonNegativeNumber);
  app.add_option("--json", a.json, "write the results to this file");
  app.add_flag("--suite", a.suite,
               "the configurations that goals are set for, in motion L with two iterations, "
               "with baselines");
  app.add_flag("--scaling", a.scaling, "every mesh size with baselines, and a plot");
  app.add_flag(
      "--floor", a.floor,
      "split steps into parts: the time of each part and the least time possible, computed from "
      "bandwidth and arithmetic measured in the same run");
  app.add_option("--plot", a.plot,
                 "picture of --scaling and --suite, PNG or SVG by its name: time against nodes")
      ->capture_default_str();
}

/// In a separate thread, so that helpers do not inherit an affinity set for an earlier run.
LatencyResult run_in_thread(const LatencyOptions& options) {
  return std::async(std::launch::async, run_latency, std::cref(options)).get();
}

int run(Arguments& a) {
  LatencyOptions& o = a.options;
  const auto order =
      a.element == "linear" ? mesh::ElementOrder::kLinear : mesh::ElementOrder::kQuadratic;
  o.mesh = a.cells.empty() ? bar_of(order, a.nodes)
                           : BarMesh{order, {a.cells[0], a.cells[1], a.cells[2]}};
  o.motion = motion_of(a.motion);
  o.mechanics = a.mechanics == "dynamic" ? Mechanics::kDynamic : Mechanics::kQuasistatic;
  o.refactor = RefactorPolicy::parse(a.refactor);
  o.solver.time_step = o.dt;
  if (!o.law.empty()) {
    if (a.suite || a.scaling || a.floor || o.baselines)
      throw std::invalid_argument("--law excludes --suite, --scaling, --floor and --baseline");
    o.checks = 0;
  }
  choose_factor(a.factor, o.solver);
  if (a.threads > 1) {
    loop::SpinTeamOptions team;
    team.size = a.threads;
    team.fifo_priority = a.fifo;
    const auto threads = std::make_shared<loop::SpinTeam>(team);
    if (!threads->remarks().empty()) std::cerr << threads->remarks() << '\n';
    o.solver.team = threads;
  }
  o.schedule = [&a] {
    for (const std::string& refusal :
         {a.cpu >= 0 ? loop::take_cpu(a.cpu) : "", a.fifo > 0 ? loop::take_fifo(a.fifo) : ""}) {
      if (!refusal.empty()) std::cerr << refusal << '\n';
    }
  };

  std::vector<LatencyOptions> wanted{o};
  if (a.suite) wanted = suite_of_goals(o);
  if (a.scaling) wanted = suite_of_sizes(o);
  std::vector<LatencyRow> rows;
  std::vector<FloorReport> floors;
  for (const LatencyOptions& options : wanted) {
    rows.push_back({options, run_in_thread(options)});
    if (a.floor && options.law.empty()) floors.push_back(find_floor(rows.back()));
    if (wanted.size() > 1) std::cerr << options.mesh.text() << " done\n";
  }
  print_latency(rows, std::cout);
  if (a.floor) {
    std::cout << '\n';
    print_floors(floors, std::cout);
  }
  if (!a.json.empty()) {
    nlohmann::json json = nlohmann::json::array();
    for (const LatencyRow& row : rows) json.push_back(to_json(row));
    for (std::size_t k = 0; k < floors.size(); ++k) json[k]["floor"] = to_json(floors[k]);
    common::write_json(json, a.json);
  }
  if (a.suite || a.scaling) draw_scaling(rows, a.plot);
  return 0;
}

}  // namespace
}  // namespace palpate::bench

int main(int argc, char** argv) {
  CLI::App app{
      "Time per step of the deformation model in the long run, its error against a converged solve "
      "of the same steps, and, as ratios, what a full refactorisation per step and Jacobi-PCG take "
      "for the same steps. Times in ms; error relative to the largest displacement."};
  palpate::bench::Arguments arguments;
  palpate::bench::add_options(app, arguments);
  if (const auto code = palpate::config::parse(app, argc, argv)) return *code;
  try {
    return palpate::bench::run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "bench_latency: " << error.what() << '\n';
    return palpate::config::kExitError;
  }
}
