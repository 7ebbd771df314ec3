#include "tools/fit/held/held_plan_command.hpp"

#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/math/constants.hpp"
#include "rt/registry/registry.hpp"
#include "tools/fit/held/held_plan_report.hpp"

namespace palpate::fit {
namespace {

struct Arguments {
  std::string configuration;
  std::vector<std::string> overrides;
  std::vector<double> markers;  // x, y, z after each other
  std::vector<double> grasp;    // lower corner, upper corner
  double turn_deg = 20;
  std::string json;
  bool ignores_wrench = false;
  HeldPlanOptions options;
};

/// The bounding box of the held nodes, overriding the configuration's.
std::string grasp_override(const std::vector<double>& box) {
  const auto corner = [&](std::size_t k) {
    return "[" + std::to_string(box[k]) + ", " + std::to_string(box[k + 1]) + ", " +
           std::to_string(box[k + 2]) + "]";
  };
  return "object.grasp_box={lower: " + corner(0) + ", upper: " + corner(3) + "}";
}

int run(Arguments arguments) {
  HeldPlanOptions& options = arguments.options;
  options.turn = arguments.turn_deg * math::kPi / 180;
  options.reads_wrench = !arguments.ignores_wrench;
  for (std::size_t k = 0; k + 2 < arguments.markers.size(); k += 3)
    options.markers.emplace_back(arguments.markers[k], arguments.markers[k + 1],
                                 arguments.markers[k + 2]);
  if (!arguments.grasp.empty()) arguments.overrides.push_back(grasp_override(arguments.grasp));
  const HeldCell cell = read_held_cell(arguments.configuration, arguments.overrides);
  const control::GateLimits limits = registry::read_gate_limits(
      config::Node::load_file(arguments.configuration, arguments.overrides));
  const HeldPlan plan = plan_motions(cell, limits, options);
  if (arguments.json == "-") {
    std::cout << to_json(plan).dump(1) << "\n";
    return 0;
  }
  print(plan, std::cout);
  if (arguments.json.empty()) return 0;
  std::ofstream file(arguments.json);
  file << to_json(plan).dump(1) << "\n";
  if (!file.flush()) throw std::runtime_error("cannot write " + arguments.json);
  return 0;
}

}  // namespace

void add_held_plan_command(CLI::App& app, int& code) {
  const auto arguments = std::make_shared<Arguments>();
  HeldPlanOptions& o = arguments->options;
  CLI::App* plan = app.add_subcommand(
      "plan",
      "Which motions of the hand would tell E, nu, density and damping of an object best, and what "
      "would stay open: a short list, D-optimal step by step");
  plan->add_option(
          "configuration", arguments->configuration,
          "palpated's, which says mesh, grasp, material as believed, and the gate's limits")
      ->required();
  plan->add_option("--set", arguments->overrides, "path.to.key=value over the configuration's")
      ->allow_extra_args(false);
  plan->add_option("--grasp", arguments->grasp,
                   "Another grasp: the nodes between two corners in O, m (six numbers)")
      ->expected(6)
      ->allow_extra_args(false);
  plan->add_option("--steps", o.steps, "Motions at most")->capture_default_str();
  plan->add_option("--amplitude", o.amplitude, "Shifts, m")->capture_default_str();
  plan->add_option("--turn", arguments->turn_deg, "Turns, degrees")->capture_default_str();
  plan->add_option("--speed", o.speed, "That a hand stops from, m/s; 0: no ringing")
      ->capture_default_str();
  plan->add_option("--hold", o.hold, "Reading time of each, s")->capture_default_str();
  plan->add_option("--rate", o.rate, "Of the force-torque sensor, Hz")->capture_default_str();
  plan->add_option("--force-noise", o.force_noise, "Standard deviation of one reading, N")
      ->capture_default_str();
  plan->add_option("--torque-noise", o.torque_noise, "Likewise, N m")->capture_default_str();
  plan->add_option("--model-error", o.model_error, "Share of a wrench that no mean takes away")
      ->capture_default_str();
  plan->add_flag("--no-wrench", arguments->ignores_wrench, "Only markers are seen");
  plan->add_option("--marker", arguments->markers, "A rest point in O that is seen, m: x y z")
      ->type_size(3);
  plan->add_option("--marker-noise", o.marker_noise, "m")->capture_default_str();
  plan->add_option("--known", o.known, "Parameters that are not sought");
  plan->add_option("--json", arguments->json, "File for the plan as JSON; - for standard output");
  plan->final_callback([arguments, &code] { code = run(*arguments); });
}

}  // namespace palpate::fit
