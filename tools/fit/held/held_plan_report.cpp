#include "tools/fit/held/held_plan_report.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "tools/common/table.hpp"

namespace palpate::fit {
namespace {

constexpr double kHalfTold = 2;  // factor from which on percentages are not used

/// "+- 3.1 %", "x or / 4.2", "+- 0.021"; in brackets if undetermined.
std::string interval(const Knowledge& known) {
  char text[40];
  if (!known.is_logarithmic) {
    std::snprintf(text, sizeof(text), "+- %.2g", known.half());
  } else if (known.factor() < kHalfTold) {
    std::snprintf(text, sizeof(text), "+- %.2g %%", 100 * (known.factor() - 1));
  } else {
    std::snprintf(text, sizeof(text), "x or / %.2g", known.factor());
  }
  return known.is_determined ? text : "(" + std::string(text) + ")";
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

}  // namespace

void print(const HeldPlan& plan, std::ostream& out) {
  out << plan.candidates - static_cast<int>(plan.left_out.size()) << " motions of "
      << plan.candidates << " are allowed. 95 % intervals to be expected, in brackets where a "
      << "parameter is not told:\n\n";
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
  if (plan.undetermined.empty()) out << "Every parameter would be told.\n";
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

}  // namespace palpate::fit
