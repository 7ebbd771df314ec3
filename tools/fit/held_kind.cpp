#include <map>

#include "tools/fit/held_decay.hpp"
#include "tools/fit/held_object.hpp"
#include "tools/fit/recording.hpp"

namespace palpate::fit {
namespace {

CalmRule read_calm_rule(const config::Node& node) {
  CalmRule rule;
  rule.linear_speed = node.number("linear_speed", {1e-6, 10}, rule.linear_speed);
  rule.angular_speed = node.number("angular_speed", {1e-6, 10}, rule.angular_speed);
  rule.settle = node.number("settle", {0, 600}, rule.settle);
  rule.window = node.number("window", {0.1, 600}, rule.window);
  rule.every = node.number("every", {0.1, 3600}, rule.every);
  return rule;
}

/// Entry `sought`: each of its words sets a flag; absent: as the flags are.
void read_sought(const config::Node& node, const std::map<std::string, bool*>& flags) {
  if (!node.has("sought")) return;
  for (const auto& [word, flag] : flags) *flag = false;
  for (const std::string& word : node.texts("sought")) {
    const auto found = flags.find(word);
    if (found == flags.end()) {
      std::string allowed;
      for (const auto& [known, flag] : flags) allowed += (allowed.empty() ? "" : ", ") + known;
      node.fail("sought", "knows no '" + word + "'; allowed: " + allowed);
    }
    *found->second = true;
  }
}

/// What both kinds say of their log and of what is in the hand.
struct HeldSource {
  std::string log, name, time;
  CalmRule rule;
  HeldCell cell;

  HeldSource(const config::Node& node, const std::filesystem::path& folder)
      : log(recording_path(folder, node.text("log")).string()),
        name(node.text("name", std::filesystem::path(log).stem().string())),
        time(node.choice("time", {"received", "sent"}, "received")),
        rule(read_calm_rule(node.child_or_empty("calm"))),
        cell(read_held_cell(node.path("configuration"),
                            node.has("set") ? node.texts("set") : std::vector<std::string>{})) {}
};

std::vector<bool> read_held_out(const config::Node& node, const HeldRecording& recording) {
  const Selection selection = read_selection(node, "held_out", false);
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
  read_sought(node, {{"poisson_ratio", &sought.poisson_ratio},
                     {"density", &sought.density},
                     {"grasp", &sought.grasp},
                     {"bias", &sought.bias},
                     {"hand", &sought.hand}});
  if (node.has("markers")) options.markers = node.points("markers");
  options.model_error = node.number("model_error", {0, 1}, options.model_error);
  options.points = node.integer("points", {1, 256}, options.points);
  HeldRecording recording =
      read_held_recording(source.log, source.rule, source.time, !options.markers.empty());
  options.is_held_out = read_held_out(node, recording);
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
  options.modes = node.integer("modes", {1, 20}, options.modes);
  read_sought(node, {{"density", &options.density},
                     {"mass_damping", &options.mass_damping},
                     {"stiffness_damping", &options.stiffness_damping}});
  std::vector<HeldRinging> ringings =
      read_ringings(source.log, source.rule, source.time, node.number("duration", {0.1, 60}, 1),
                    node.number("rate", {10, 1e4}, 200));
  try {
    return std::make_unique<HeldDecay>(source.name, source.cell, std::move(ringings), options);
  } catch (const std::invalid_argument& error) {
    node.fail("configuration", error.what());
  }
}

}  // namespace palpate::fit
