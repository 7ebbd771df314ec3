#include "tools/fit/plan.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <set>

#include "tools/fit/recording.hpp"

namespace palpate::fit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// `upper` laid over `lower`, mappings both as text.
config::Node laid_over(const config::Node& lower, const std::string& upper,
                       const std::string& name) {
  return upper.empty() ? lower : lower.changed("", upper, false, name);
}

std::map<std::string, ParameterChange> read_parameters(const config::Node& node) {
  std::map<std::string, ParameterChange> changes;
  if (!node.has("parameters")) return changes;
  const config::Node parameters = node.child("parameters");
  for (const std::string& name : parameters.keys()) {
    const config::Node entry = parameters.child(name);
    ParameterChange change;
    const auto read = [&](const char* key, std::optional<double>& to) {
      if (entry.has(key)) to = entry.number(key, {-kInfinity, kInfinity});
    };
    read("start", change.start);
    read("lower", change.lower);
    read("upper", change.upper);
    read("known", change.known);
    changes[name] = change;
  }
  return changes;
}

FitOptions read_solver(const config::Node& node, FitOptions options) {
  SolverOptions& solver = options.solver;
  const std::string loss = node.choice("loss", {"none", "huber", "cauchy"}, "none");
  solver.loss.kind = loss == "huber"    ? Loss::Kind::kHuber
                     : loss == "cauchy" ? Loss::Kind::kCauchy
                                        : Loss::Kind::kNone;
  solver.loss.scale = node.number("loss_scale", {0.1, 100}, solver.loss.scale);
  solver.starts = node.integer("starts", {1, 10000}, solver.starts);
  solver.seed = node.integer("seed", {0, 1e9}, solver.seed);
  solver.iterations = node.integer("iterations", {1, 1e6}, solver.iterations);
  solver.tolerance = node.number("tolerance", {1e-15, 1e-2}, solver.tolerance);
  const std::string profile = node.choice("profile", {"auto", "always", "never"}, "auto");
  options.profile = profile == "always"  ? Profile::kAlways
                    : profile == "never" ? Profile::kNever
                                         : Profile::kAuto;
  options.is_reweighed = node.flag("reweigh", options.is_reweighed);
  return options;
}

/// What a plan lays over its fits, or nothing.
struct Variant {
  std::string name;
  std::string recording;  // YAML, as the next two
  std::string solver;
  std::string parameters;
};

std::vector<Variant> read_variants(const config::Node& node) {
  std::vector<Variant> variants;
  for (const config::Node& entry : node.list("variants")) {
    variants.push_back({entry.text("name"), entry.dump("recording"), entry.dump("solver"),
                        entry.dump("parameters")});
    for (const char* key : {"recording", "solver", "parameters"}) entry.leave_to_another(key);
  }
  if (variants.empty()) variants.emplace_back();
  return variants;
}

/// A fit of the plan: the same for every value of `each` and every variant.
struct Entry {
  std::string name;
  std::string group;
  std::vector<std::string> recordings;  // YAML
  std::string parameters;               // YAML
  std::string each;
  std::vector<std::string> variants;  // only these; empty: all

  bool has(const std::string& variant) const {
    return variants.empty() ||
           std::find(variants.begin(), variants.end(), variant) != variants.end();
  }
};

Entry read_entry(const config::Node& node, const std::string& name, bool is_in_list) {
  Entry entry;
  entry.name = name;
  entry.group = node.text("group", name);
  for (const config::Node& recording : node.list("recordings"))
    entry.recordings.push_back(recording.dump());
  if (entry.recordings.empty()) node.fail("recordings", "must hold one or more");
  entry.parameters = node.dump("parameters");
  entry.each = node.text("each", "");
  if (is_in_list && node.has("variants")) entry.variants = node.texts("variants");
  node.leave_to_another("recordings");
  node.leave_to_another("parameters");
  return entry;
}

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

}  // namespace

std::string Job::title() const { return variant.empty() ? name : name + ", " + variant; }

Plan read_plan(const config::Node& node, const std::filesystem::path& data) {
  Plan plan;
  plan.name = node.text("name");
  plan.about = node.text("about", "");
  plan.hash = std::to_string(node.hash());
  const config::Node nothing = config::Node::from_text("{}", plan.name);
  const config::Node common = laid_over(nothing, node.dump("recording"), plan.name);
  const config::Node solver = laid_over(nothing, node.dump("solver"), plan.name);
  const config::Node parameters = laid_over(nothing, node.dump("parameters"), plan.name);
  for (const char* key : {"recording", "solver", "parameters"}) node.leave_to_another(key);
  const double effective_strain = node.child_or_empty("effective").number("strain", {1e-6, 100}, 0);
  const std::vector<Variant> variants = read_variants(node);
  std::vector<Entry> entries;
  std::set<std::string> names;
  for (const config::Node& entry : node.list("fits")) {
    entries.push_back(read_entry(entry, entry.text("name"), true));
    if (!names.insert(entries.back().name).second) entry.fail("name", "comes twice");
  }
  if (entries.empty()) entries.push_back(read_entry(node, plan.name, false));
  node.check_all_used();

  for (const Variant& variant : variants) {
    const config::Node settings = laid_over(solver, variant.solver, plan.name + ": solver");
    const FitOptions options = read_solver(settings, {});
    settings.check_all_used();
    for (const Entry& entry : entries) {
      if (!entry.has(variant.name)) continue;
      const std::string place = plan.name + ": " + entry.name;
      config::Node changes =
          laid_over(laid_over(parameters, entry.parameters, place), variant.parameters, place);
      changes = config::Node::from_text("parameters: {}", plan.name)
                    .changed("parameters", changes.dump(), false, place);
      Job job{entry.group,  entry.name,
              variant.name, !entry.each.empty(),
              {},           read_parameters(changes),
              options,      effective_strain};
      changes.check_all_used();
      for (const std::string& recording : entry.recordings)
        job.recordings.push_back(
            laid_over(laid_over(common, variant.recording, place), recording, place));
      if (entry.each.empty()) {
        plan.jobs.push_back(std::move(job));
        continue;
      }
      const std::string file = job.recordings.front().text("file");
      for (const double value : distinct_values(recording_path(data, file), entry.each)) {
        Job one = job;
        const std::string text = short_number(value);
        one.name = entry.name + " " + text;
        for (config::Node& recording : one.recordings)
          recording = laid_over(recording, "{where: {" + entry.each + ": " + text + "}}", place);
        plan.jobs.push_back(std::move(one));
      }
    }
  }
  return plan;
}

}  // namespace palpate::fit
