#include "tools/train/plan.hpp"

#include <algorithm>
#include <set>

#include "core/sensing/input_domain.hpp"
#include "core/sensing/recurrent_observer_inputs.hpp"

namespace palpate::train {
namespace {

std::vector<Interval> read_intervals(const config::Node& node, const std::string& key) {
  std::vector<Interval> intervals;
  if (!node.has(key)) return intervals;
  const std::vector<double> ends = node.numbers(key, -1, {0, 1e9});
  if (ends.size() % 2 != 0) node.fail(key, "must hold pairs, begin and end");
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    if (!(ends[i] < ends[i + 1])) node.fail(key, "an interval must begin before it ends");
    intervals.push_back({ends[i], ends[i + 1]});
  }
  return intervals;
}

std::vector<ColumnGroup> read_groups(const config::Node& data, const std::string& key) {
  std::vector<ColumnGroup> groups;
  std::set<std::string> names;
  for (const config::Node& node : data.list(key)) {
    ColumnGroup group;
    group.columns = node.texts("columns");
    group.unit = node.text("unit");
    group.name = node.text("name", key);
    group.floor = node.number("floor", {1e-9, 1e9});
    group.unit_length = node.number("unit_length", {0, 1e9}, 0);
    group.is_direction = node.flag("direction", false);
    for (const std::string& column : group.columns)
      if (!names.insert(column).second) node.fail("columns", "'" + column + "' comes twice");
    groups.push_back(group);
  }
  const auto scaled = std::count_if(groups.begin(), groups.end(),
                                    [](const ColumnGroup& g) { return g.unit_length > 0; });
  if (scaled > 1) data.fail(key, "may hold one group with unit_length");
  if (groups.empty()) data.fail(key, "must hold one group of columns or more");
  return groups;
}

WristColumns read_wrist(const config::Node& node) {
  WristColumns wrist;
  const auto read = [&](const char* key, std::size_t count) {
    std::vector<std::string> columns = node.texts(key);
    if (columns.size() != count) node.fail(key, "must name " + std::to_string(count) + " columns");
    return columns;
  };
  wrist.quaternion = read("quaternion", 4);
  wrist.velocity = read("velocity", 3);
  wrist.rate = read("rate", 3);
  wrist.acceleration = read("acceleration", 3);
  wrist.force = read("force", 3);
  wrist.torque = read("torque", 3);
  if (node.has("position")) wrist.position = read("position", 3);
  if (node.has("drifting")) wrist.drifting = node.texts("drifting");
  wrist.acceleration_has_gravity = node.flag("acceleration_has_gravity", true);
  wrist.largest_delay = node.number("largest_delay", {0, 2}, 0.2);
  return wrist;
}

DataPlan read_data(const config::Node& node) {
  DataPlan data;
  data.is_wrist = node.has("wrist");
  data.time = node.text("time");
  data.rate = node.number("rate", {1, 10000});
  data.average = node.number("average", {0, 10}, 0);
  data.tare = node.number("tare", {0, 1000}, 0);
  data.tare_outputs = node.flag("tare_outputs", true);
  data.retare = node.number("retare", {0, 1000}, 2);
  data.inputs = read_groups(node, "inputs");
  data.outputs = read_groups(node, "outputs");
  if (node.has("contact")) {
    const config::Node contact = node.child("contact");
    data.contact_column = contact.text("column");
    data.contact_threshold = contact.number("above", {-1e9, 1e9});
  }
  data.target = node.choice("target", {"measured", "residual"}, "measured") == "residual"
                    ? Target::kResidual
                    : Target::kMeasured;
  if (data.is_wrist) {
    data.wrist = read_wrist(node.child("wrist"));
    for (const std::string& name : columns_of(data.inputs))
      if (sensing::observer_input_index(name) < 0)
        node.fail("inputs", "'" + name + "' is not an input of a wrist's observer");
      else if (name.rfind("position_", 0) == 0 && data.wrist.position.empty())
        node.fail("inputs", "'" + name + "' wants wrist.position");
    const std::vector<std::string> outputs = columns_of(data.outputs);
    for (const std::string& name : data.wrist.drifting)
      if (std::find(outputs.begin(), outputs.end(), name) == outputs.end())
        node.fail("wrist", "'" + name + "' of drifting is not an output");
    if (columns_of(data.outputs).size() != 6)
      node.fail("outputs", "of a wrist must be three forces and three torques");
  } else if (data.target == Target::kResidual) {
    node.fail("target", "residual needs `wrist`");
  }
  for (const config::Node& entry : node.list("recordings"))
    data.recordings.push_back({entry.text("file"), entry.text("column", ""),
                               read_intervals(entry, "validation"), read_intervals(entry, "test"),
                               entry.integer("validate_every", {0, 1e6}, 0)});
  if (data.recordings.empty()) node.fail("recordings", "must hold one or more");
  return data;
}

NetworkPlan read_network(const config::Node& node) {
  NetworkPlan network;
  network.layers.clear();
  for (const double size : node.numbers("layers", -1, {1, 512})) {
    network.layers.push_back(static_cast<int>(size));
    if (network.layers.back() != size) node.fail("layers", "must be whole numbers");
  }
  if (network.layers.empty() || network.layers.size() > 8)
    node.fail("layers", "must be one to eight");
  network.linear = node.flag("linear", network.linear);
  network.shrink = node.flag("shrink", network.shrink);
  if (node.has("domain")) {
    const config::Node domain = node.child("domain");
    network.domain_points = domain.integer("points", {0, sensing::InputDomain::kLargestPoints}, 64);
    network.domain_near = domain.number("near", {0, 1e6}, network.domain_near);
    network.domain_far = domain.number("far", {0, 1e6}, network.domain_far);
    if (!(network.domain_near < network.domain_far)) domain.fail("far", "must be above near");
  }
  if (node.has("penalties")) network.penalties = node.numbers("penalties", -1, {0, 1e9});
  if (network.penalties.empty()) node.fail("penalties", "must be one or more");
  return network;
}

TrainingPlan read_training(const config::Node& node) {
  TrainingPlan t;
  t.seed = node.integer("seed", {0, 1e9}, t.seed);
  t.iterations = node.integer("iterations", {0, 1e7}, t.iterations);
  t.evaluate_every = node.integer("evaluate_every", {1, 1e6}, t.evaluate_every);
  t.patience = node.integer("patience", {1, 1e6}, t.patience);
  t.lanes = node.integer("lanes", {1, 4096}, t.lanes);
  t.steps = node.integer("steps", {1, 10000}, t.steps);
  t.carry = node.flag("carry", t.carry);
  t.burn_in = node.integer("burn_in", {0, 10000}, t.burn_in);
  if (t.burn_in >= t.steps) node.fail("burn_in", "must be below steps");
  t.rate = node.number("rate", {1e-7, 1}, t.rate);
  t.clip = node.number("clip", {1e-6, 1e6}, t.clip);
  t.weight_decay = node.number("weight_decay", {0, 10}, t.weight_decay);
  t.input_noise = node.number("input_noise", {0, 10}, t.input_noise);
  t.keep_last = node.choice("keep", {"best", "last"}, "best") == "last";
  t.refit = node.flag("refit", t.refit);
  return t;
}

}  // namespace

Plan read_plan(const config::Node& node) {
  Plan plan;
  plan.name = node.text("name");
  plan.start_from = node.text("start_from", "");
  plan.data = read_data(node.child("data"));
  plan.network = read_network(node.child("network"));
  plan.training = read_training(node.child_or_empty("training"));
  if (plan.network.domain_points > 0 && plan.data.target != Target::kResidual)
    node.fail("network", "domain wants the target residual");
  node.check_all_used();
  return plan;
}

std::vector<std::string> columns_of(const std::vector<ColumnGroup>& groups) {
  std::vector<std::string> columns;
  for (const ColumnGroup& group : groups)
    columns.insert(columns.end(), group.columns.begin(), group.columns.end());
  return columns;
}

}  // namespace palpate::train
