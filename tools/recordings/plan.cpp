#include "tools/recordings/plan.hpp"

#include <algorithm>
#include <set>

#include "core/sensing/input_domain.hpp"
#include "core/sensing/recurrent_observer_inputs.hpp"

namespace palpate::recordings {
namespace {

std::vector<Interval> read_intervals(const config::Node& node, const config::Key& key) {
  std::vector<Interval> intervals;
  if (!node.has(key.name)) return intervals;
  const std::vector<double> ends = node.numbers(key, -1, {0, 1e9});
  if (ends.size() % 2 != 0) node.fail(key.name, "must hold pairs, begin and end");
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    if (!(ends[i] < ends[i + 1])) node.fail(key.name, "an interval must begin before it ends");
    intervals.push_back({ends[i], ends[i + 1]});
  }
  return intervals;
}

std::vector<ColumnGroup> read_groups(const config::Node& data, const config::Key& key) {
  std::vector<ColumnGroup> groups;
  std::set<std::string> names;
  for (const config::Node& node : data.list(key)) {
    ColumnGroup group;
    group.columns = node.texts(
        {"columns", "", "columns of the recordings, or names of a wrist observer's inputs"});
    group.unit = node.text({"unit", "", "of all of them; the card keeps it"});
    group.name = node.text({"name", "", "for tables; absent: as the list"}, key.name);
    group.floor = node.number(
        {"floor", "",
         "least deviation that they are divided by, in their unit (1 after unit_length)"},
        {1e-9, 1e9});
    group.unit_length = node.number(
        {"unit_length", "",
         "above 0: divided first by the root of the group's square and that of this length"},
        {0, 1e9}, 0);
    group.is_direction =
        node.flag({"direction", "", "scored by angle, as the normal of a touched skin"}, false);
    for (const std::string& column : group.columns)
      if (!names.insert(column).second) node.fail("columns", "'" + column + "' comes twice");
    groups.push_back(group);
  }
  const auto scaled = std::count_if(groups.begin(), groups.end(),
                                    [](const ColumnGroup& g) { return g.unit_length > 0; });
  if (scaled > 1) data.fail(key.name, "may hold one group with unit_length");
  if (groups.empty()) data.fail(key.name, "must hold one group of columns or more");
  return groups;
}

WristColumns read_wrist(const config::Node& node) {
  WristColumns wrist;
  const auto read = [&](const config::Key& key, std::size_t count) {
    std::vector<std::string> columns = node.texts(key);
    if (columns.size() != count)
      node.fail(key.name, "must name " + std::to_string(count) + " columns");
    return columns;
  };
  wrist.quaternion = read({"quaternion", "", "w, x, y, z of the sensor in W"}, 4);
  wrist.velocity = read({"velocity", "m/s", "columns of the velocity in W"}, 3);
  wrist.rate = read({"rate", "rad/s", "columns of the angular velocity in S"}, 3);
  wrist.acceleration = read({"acceleration", "m/s^2", "columns of the acceleration in S"}, 3);
  wrist.force = read({"force", "N", "columns of the force in S"}, 3);
  wrist.torque = read({"torque", "N m", "columns of the torque in S"}, 3);
  if (node.has("position"))
    wrist.position =
        read({"position", "m", "columns of the position in W; for inputs that want it"}, 3);
  if (node.has("drifting"))
    wrist.drifting =
        node.texts({"drifting", "", "outputs whose bias drifts evenly along a recording"});
  wrist.acceleration_has_gravity = node.flag(
      {"acceleration_has_gravity", "", "false: the recording's acceleration is without gravity"},
      true);
  wrist.largest_delay = node.number(
      {"largest_delay", "s", "that is looked for between the streams of a recording"}, {0, 2}, 0.2);
  return wrist;
}

DataPlan read_data(const config::Node& node) {
  DataPlan data;
  data.is_wrist = node.has("wrist");
  data.time = node.text({"time", "", "column of the time in s"});
  data.rate = node.number({"rate", "Hz", "of the network's steps"}, {1, 10000});
  data.average = node.number({"average", "s", "trailing mean of all columns; 0: the latest sample"},
                             {0, 10}, 0);
  data.tare = node.number({"tare", "s", "at the start of a recording, whose mean is zero; 0: none"},
                          {0, 1000}, 0);
  data.tare_outputs = node.flag({"tare_outputs", "", "the outputs as well"}, true);
  data.retare = node.number(
      {"retare", "s", "at the start of a recording over which errors may be tared again"},
      {0, 1000}, 2);
  data.inputs = read_groups(node, {"inputs", "", "columns that go in, by kind"});
  data.outputs = read_groups(node, {"outputs", "", "columns that come out, by kind"});
  if (node.has("contact")) {
    const config::Node contact = node.child({"contact", "", "rows that count; absent: all"});
    data.contact_column = contact.text({"column", "", "that indicates contact"});
    data.contact_threshold = contact.number(
        {"above", "", "rows count where the column, tared, is above this"}, {-1e9, 1e9});
  }
  data.target =
      node.choice(
          {"target", "",
           "what is learnt: what was measured, or what a rigid payload does not explain of it"},
          {"measured", "residual"}, "measured") == "residual"
          ? Target::kResidual
          : Target::kMeasured;
  if (data.is_wrist) {
    data.wrist = read_wrist(node.child(
        {"wrist", "",
         "the recordings are those of a sensor at a moving wrist: where its signals stand"}));
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
  for (const config::Node& entry :
       node.list({"recordings", "", "of training, validation and test"}))
    data.recordings.push_back(
        {entry.text({"file", "", "CSV or LCM log below the folder of the data"}),
         entry.text({"column", "",
                     "that names the recordings of the file, one behind the other; absent: one"},
                    ""),
         read_intervals(entry, {"validation", "s", "begin and end of each interval of time"}),
         read_intervals(entry,
                        {"test", "s", "begin and end of each interval of time, never trained on"}),
         entry.integer({"validate_every", "",
                        "each so many-th recording of the file is validation, whole; 0: none"},
                       {0, 1e6}, 0)});
  if (data.recordings.empty()) node.fail("recordings", "must hold one or more");
  return data;
}

NetworkPlan read_network(const config::Node& node) {
  NetworkPlan network;
  network.layers.clear();
  for (const double size : node.numbers(
           {"layers", "", "cells of each layer of the recurrent network, one to eight layers"}, -1,
           {1, 512})) {
    network.layers.push_back(static_cast<int>(size));
    if (network.layers.back() != size) node.fail("layers", "must be whole numbers");
  }
  if (network.layers.empty() || network.layers.size() > 8)
    node.fail("layers", "must be one to eight");
  network.linear = node.flag(
      {"linear", "", "a ridge regression in parallel with the cells, which learn what it leaves"},
      network.linear);
  network.shrink = node.flag(
      {"shrink", "", "each output takes of the cells only what served it on the validation rows"},
      network.shrink);
  if (node.has("domain")) {
    const config::Node domain = node.child(
        {"domain", "", "away from the inputs of the training the answer fades (target residual)"});
    network.domain_points = domain.integer({"points", "", "that cover the inputs of the training"},
                                           {0, sensing::InputDomain::kLargestPoints}, 64);
    network.domain_near = domain.number(
        {"near", "", "where it begins to fade, in the distance within which all of them lie"},
        {0, 1e6}, network.domain_near);
    network.domain_far =
        domain.number({"far", "", "where it is gone, in the same"}, {0, 1e6}, network.domain_far);
    if (!(network.domain_near < network.domain_far)) domain.fail("far", "must be above near");
  }
  if (node.has("penalties"))
    network.penalties = node.numbers(
        {"penalties", "", "of the ridge regression, tried on the validation rows"}, -1, {0, 1e9});
  if (network.penalties.empty()) node.fail("penalties", "must be one or more");
  return network;
}

TrainingPlan read_training(const config::Node& node) {
  TrainingPlan t;
  t.seed = node.integer({"seed", "", "of all randomness"}, {0, 1e9}, t.seed);
  t.iterations = node.integer({"iterations", "", "at most"}, {0, 1e7}, t.iterations);
  t.evaluate_every =
      node.integer({"evaluate_every", "", "iterations between two looks at the validation rows"},
                   {1, 1e6}, t.evaluate_every);
  t.patience = node.integer({"patience", "", "looks without improvement after which it ends"},
                            {1, 1e6}, t.patience);
  t.lanes = node.integer({"lanes", "", "sequences at once"}, {1, 4096}, t.lanes);
  t.steps = node.integer({"steps", "", "of truncated back-propagation"}, {1, 10000}, t.steps);
  t.carry = node.flag(
      {"carry", "", "state from one piece of a sequence to the next; false: windows"}, t.carry);
  t.burn_in = node.integer(
      {"burn_in", "", "first steps after a state of zero, which do not count; below steps"},
      {0, 10000}, t.burn_in);
  if (t.burn_in >= t.steps) node.fail("burn_in", "must be below steps");
  t.rate =
      node.number({"rate", "", "of Adam; falls to a tenth along half a cosine"}, {1e-7, 1}, t.rate);
  t.clip = node.number({"clip", "", "largest norm of the gradient"}, {1e-6, 1e6}, t.clip);
  t.weight_decay = node.number({"weight_decay", "", "of Adam"}, {0, 10}, t.weight_decay);
  t.input_noise = node.number({"input_noise", "", "standard deviation, of normalised inputs"},
                              {0, 10}, t.input_noise);
  t.keep_last =
      node.choice({"keep", "", "the cells that were best on the validation rows, or the last"},
                  {"best", "last"}, "best") == "last";
  t.refit =
      node.flag({"refit", "", "the file holds a network trained once more on all parts"}, t.refit);
  return t;
}

}  // namespace

Plan read_plan(const config::Node& node) {
  Plan plan;
  plan.name = node.text({"name", "", "of the model and its files"});
  plan.start_from =
      node.text({"start_from", "", "Module from which the training continues; absent: none"}, "");
  plan.data = read_data(node.child({"data", "", "recordings and their columns"}));
  plan.network = read_network(node.child({"network", "", "what is trained"}));
  plan.training = read_training(node.child_or_empty({"training", "", "how"}));
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

}  // namespace palpate::recordings
