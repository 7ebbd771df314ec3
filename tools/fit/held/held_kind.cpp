#include <map>

#include "tools/fit/held/held_decay.hpp"
#include "tools/fit/held/held_object.hpp"
#include "tools/fit/recording.hpp"

namespace palpate::fit {
namespace {

CalmRule read_calm_rule(const config::Node& node) {
  CalmRule rule;
  rule.linear_speed = node.number({"linear_speed", "m/s", "of the hand, below which it rests"},
                                  {1e-6, 10}, rule.linear_speed);
  rule.angular_speed = node.number({"angular_speed", "rad/s", "below which it rests"}, {1e-6, 10},
                                   rule.angular_speed);
  rule.settle =
      node.number({"settle", "s", "of rest before anything counts"}, {0, 600}, rule.settle);
  rule.window =
      node.number({"window", "s", "over which a sample is the mean"}, {0.1, 600}, rule.window);
  rule.every =
      node.number({"every", "s", "between samples of a long rest"}, {0.1, 3600}, rule.every);
  return rule;
}

/// Entry `sought`, with its words described by `what`: each sets a flag; if absent, the flags are
/// unchanged.
void read_sought(const config::Node& node, const char* what,
                 const std::map<std::string, bool*>& flags) {
  if (!node.has("sought")) return;
  for (const auto& [word, flag] : flags) *flag = false;
  for (const std::string& word : node.texts({"sought", "", what})) {
    const auto found = flags.find(word);
    if (found == flags.end()) {
      std::string allowed;
      for (const auto& [known, flag] : flags) allowed += (allowed.empty() ? "" : ", ") + known;
      node.fail("sought", "knows no '" + word + "'; allowed: " + allowed);
    }
    *found->second = true;
  }
}

/// Keys of both kinds for their log and the object in the hand.
struct HeldSource {
  std::string log, name, time;
  CalmRule rule;
  std::string configuration;
  std::vector<std::string> overrides;
  HeldCell cell;

  HeldSource(const config::Node& node, const std::filesystem::path& folder)
      : log(recording_path(folder, node.text({"log", "", "of LCM, in the folder of the data"}))
                .string()),
        name(node.text({"name", "", "of the recording; absent: the log's"}, "")),
        time(node.choice({"time", "", "by when a message was received, or sent"},
                         {"received", "sent"}, "received")),
        rule(read_calm_rule(node.child_or_empty({"calm", "", "when the hand rests"}))),
        configuration(node.path({"configuration", "", "of palpated, which describes the object"})) {
    if (name.empty()) name = std::filesystem::path(log).stem().string();
    if (node.has("set")) overrides = node.texts({"set", "", "laid over it: path.to.key=value"});
    cell = read_held_cell(configuration, overrides);
  }

  /// Gives a hand with rigid pads compliant ones, whose stiffness is identified then.
  void assume_pads() {
    if (!cell.object.body.grasps[0].compliance.isZero(0)) return;
    overrides.push_back("object.grasp_stiffness=" + std::to_string(kPadStiffness));
    cell = read_held_cell(configuration, overrides);
  }
};

std::vector<bool> held_out_of(const Selection& selection, const config::Node& node,
                              const HeldRecording& recording) {
  if (selection.quantity.empty())
    return selection.is_all ? std::vector<bool>(recording.samples.size(), true)
                            : std::vector<bool>();
  if (selection.quantity != "time" && selection.quantity != "sample")
    node.fail("held_out", "knows no quantity '" + selection.quantity + "'; allowed: time, sample");
  std::vector<bool> held_out;
  for (std::size_t i = 0; i < recording.samples.size(); ++i)
    held_out.push_back(selection.holds(selection.quantity == "time" ? recording.samples[i].time
                                                                    : static_cast<double>(i)));
  return held_out;
}

}  // namespace

std::unique_ptr<Experiment> make_held_object(const config::Node& node,
                                             const std::filesystem::path& folder) {
  HeldSource source(node, folder);
  HeldOptions options;
  HeldSought& sought = options.sought;
  read_sought(
      node,
      "identified in addition to Young's modulus: poisson_ratio, density, grasp (pose of the "
      "hand), bias (of the sensor), hand (its weight), pads (their stiffness); absent: "
      "poisson_ratio and bias",
      {{"poisson_ratio", &sought.poisson_ratio},
       {"density", &sought.density},
       {"grasp", &sought.grasp},
       {"bias", &sought.bias},
       {"hand", &sought.hand},
       {"pads", &sought.pads}});
  if (sought.pads) source.assume_pads();
  if (node.has("markers"))
    options.markers =
        node.points({"markers", "m", "at rest, in the object, that a camera follows"});
  options.model_error = node.number({"model_error", "", "share of a wrench that no model explains"},
                                    {0, 1}, options.model_error);
  options.points = node.integer({"points", "", "of the surface, by which shapes are compared"},
                                {1, 256}, options.points);
  const Selection selection = read_selection(node, kHeldOut, false);
  HeldRecording recording =
      read_held_recording(source.log, source.rule, source.time, !options.markers.empty());
  options.is_held_out = held_out_of(selection, node, recording);
  try {
    return std::make_unique<HeldObject>(source.name, std::move(source.cell), std::move(recording),
                                        options);
  } catch (const std::invalid_argument& error) {
    node.fail("configuration", error.what());
  }
}

std::unique_ptr<Experiment> make_held_decay(const config::Node& node,
                                            const std::filesystem::path& folder) {
  const HeldSource source(node, folder);
  HeldDecayOptions options;
  options.modes = node.integer({"modes", "", "of the object, that ring"}, {1, 20}, options.modes);
  read_sought(
      node,
      "identified in addition to Young's modulus: density, mass_damping, stiffness_damping; "
      "absent: mass_damping",
      {{"density", &options.density},
       {"mass_damping", &options.mass_damping},
       {"stiffness_damping", &options.stiffness_damping}});
  const double duration =
      node.number({"duration", "s", "after a stop, that is looked at"}, {0.1, 60}, 1);
  const double rate = node.number({"rate", "Hz", "at which it is looked at"}, {10, 1e4}, 200);
  std::vector<HeldRinging> ringings =
      read_ringings(source.log, source.rule, source.time, duration, rate);
  try {
    return std::make_unique<HeldDecay>(source.name, source.cell, std::move(ringings), options);
  } catch (const std::invalid_argument& error) {
    node.fail("configuration", error.what());
  }
}

}  // namespace palpate::fit
