#include "tools/fit/held/held_plan_report.hpp"

#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/math/constants.hpp"
#include "rt/registry/registry.hpp"
#include "tools/common/output_files.hpp"
#include "tools/common/table.hpp"

namespace palpate::fit {
namespace {

constexpr double kVague = 2;  // factor from which on percentages are not used

/// "+- 3.1 %", "x or / 4.2", "+- 0.021"; in brackets if undetermined.
std::string interval(const Knowledge& known) {
  const std::string text = !known.is_logarithmic ? common::formatted("+- %.2g", known.half())
                           : known.factor() < kVague
                               ? common::formatted("+- %.2g %%", 100 * (known.factor() - 1))
                               : common::formatted("x or / %.2g", known.factor());
  return known.is_determined ? text : "(" + text + ")";
}

nlohmann::json to_json(const std::vector<Knowledge>& knowledge) {
  nlohmann::json json;
  for (const Knowledge& known : knowledge) {
    const bool is_factor = known.is_logarithmic;
    json[known.name] = {{"value", known.value},
                        {"interval",
                         {is_factor ? known.value / known.factor() : known.value - known.half(),
                          is_factor ? known.value * known.factor() : known.value + known.half()}},
                        {"determined", known.is_determined}};
  }
  return json;
}

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
  if (arguments.json != "-") print(plan, std::cout);
  if (!arguments.json.empty()) common::write_json(to_json(plan), arguments.json);
  return 0;
}

}  // namespace

void print(const HeldPlan& plan, std::ostream& out) {
  out << plan.candidates - static_cast<int>(plan.left_out.size()) << " motions of "
      << plan.candidates << " are allowed. 95 % intervals to be expected, in brackets where a "
      << "parameter is not determined:\n\n";
  std::vector<std::string> header = {"motion"};
  for (const Knowledge& known : plan.before) header.push_back(known.name);
  common::Table table(header);
  const auto add = [&](const std::string& title, const std::vector<Knowledge>& knowledge) {
    std::vector<std::string> row = {title};
    for (const Knowledge& known : knowledge) row.push_back(interval(known));
    table.add(row);
  };
  add("before any", plan.before);
  for (std::size_t s = 0; s < plan.steps.size(); ++s)
    add(std::to_string(s + 1) + ". " + plan.steps[s].motion.name, plan.steps[s].knowledge);
  table.print(out);
  out << "\n";
  if (plan.undetermined.empty()) out << "Every parameter would be determined.\n";
  for (const std::string& name : plan.undetermined) out << "Stays undetermined: " << name << "\n";
  if (!plan.left_out.empty()) {
    out << "Left out:\n";
    for (const std::string& reason : plan.left_out) out << "  " << reason << "\n";
  }
}

nlohmann::json to_json(const HeldPlan& plan) {
  const auto vector = [](const math::Vector6d& v) {
    return std::vector<double>(v.data(), v.data() + 6);
  };
  nlohmann::json json = {{"candidates", plan.candidates},
                         {"left_out", plan.left_out},
                         {"before", to_json(plan.before)},
                         {"undetermined", plan.undetermined},
                         {"steps", nlohmann::json::array()}};
  for (const HeldPlanStep& step : plan.steps)
    json["steps"].push_back({{"motion", step.motion.name},
                             {"grasp_from_rest", vector(step.motion.from_rest)},
                             {"stop_from_twist", vector(step.motion.stop)},
                             {"gain", step.gain},
                             {"after", to_json(step.knowledge)}});
  return json;
}

void add_held_plan_command(CLI::App& app, int& code) {
  const auto arguments = std::make_shared<Arguments>();
  HeldPlanOptions& o = arguments->options;
  CLI::App* plan = app.add_subcommand("plan",
                                      "Which motions of the hand would determine E, nu, density "
                                      "and damping of an object best, and what "
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
