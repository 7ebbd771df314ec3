#include "tools/fit/plan.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <set>

#include "tools/common/table.hpp"
#include "tools/fit/recording.hpp"

namespace palpate::fit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// `upper` merged over `lower`, both mappings as text.
config::Node laid_over(const config::Node& lower, const std::string& upper,
                       const std::string& name) {
  return upper.empty() ? lower : lower.changed("", upper, false, name);
}

/// A document with the mapping under `key`, so that error messages name the full path.
config::Node under(const std::string& key, const config::Node& mapping, const std::string& plan,
                   const std::string& place) {
  return config::Node::from_text(key + ": {}", plan).changed(key, mapping.dump(), false, place);
}

std::map<std::string, ParameterChange> read_parameters(const config::Node& node) {
  std::map<std::string, ParameterChange> changes;
  if (!node.has("parameters")) return changes;
  const config::Node parameters =
      node.child_or_empty({"parameters", "", "how each is sought, by its name"});
  for (const std::string& name : parameters.keys()) {
    const config::Node entry =
        parameters.child_or_empty({name, "", "absent: as the kind of recording has it"});
    ParameterChange change;
    const auto read = [&](const config::Key& key, std::optional<double>& to) {
      if (entry.has(key.name)) to = entry.number(key, {-kInfinity, kInfinity});
    };
    read({"start", "SI", "where the search begins"}, change.start);
    read({"lower", "SI", "it is sought above this"}, change.lower);
    read({"upper", "SI", "it is sought below this"}, change.upper);
    read({"known", "SI", "it is this, and not sought"}, change.known);
    changes[name] = change;
  }
  return changes;
}

FitOptions read_solver(const config::Node& node, FitOptions options) {
  SolverOptions& solver = options.solver;
  const std::string loss = node.choice(
      {"loss", "", "what far-off samples weigh: as all, in proportion, or by a logarithm"},
      {"none", "huber", "cauchy"}, "none");
  solver.loss.kind = loss == "huber"    ? Loss::Kind::kHuber
                     : loss == "cauchy" ? Loss::Kind::kCauchy
                                        : Loss::Kind::kNone;
  solver.loss.scale = node.number({"loss_scale", "deviations", "from where on a sample is far off"},
                                  {0.1, 100}, solver.loss.scale);
  solver.starts = node.integer(
      {"starts", "", "places where the search begins, the first being `start`, others by chance"},
      {1, 10000}, solver.starts);
  solver.seed = node.integer({"seed", "", "of those by chance"}, {0, 1e9}, solver.seed);
  solver.iterations =
      node.integer({"iterations", "", "at most, of one search"}, {1, 1e6}, solver.iterations);
  solver.tolerance =
      node.number({"tolerance", "", "relative change of the cost below which a search ends"},
                  {1e-15, 1e-2}, solver.tolerance);
  const std::string profile = node.choice(
      {"profile", "", "intervals by profiles of the likelihood, or where the curvature misleads"},
      {"auto", "always", "never"}, "auto");
  options.profile = profile == "always"  ? Profile::kAlways
                    : profile == "never" ? Profile::kNever
                                         : Profile::kAuto;
  options.is_reweighed = node.flag(
      {"reweigh", "", "deviations of series are taken from their residuals, then fitted again"},
      options.is_reweighed);
  return options;
}

/// Settings that a plan applies to its fits, or none.
struct Variant {
  std::string name;
  std::string recording;  // YAML, as the next two
  std::string solver;
  std::string parameters;
};

std::vector<Variant> read_variants(const config::Node& node) {
  std::vector<Variant> variants;
  for (const config::Node& entry : node.list(
           {"variants", "",
            "each fit is done with each of them: `recording`, `solver`, `parameters` laid over the "
            "plan's"})) {
    variants.push_back({entry.text({"name", "", "of the variant"}), entry.dump("recording"),
                        entry.dump("solver"), entry.dump("parameters")});
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
  entry.group = name;
  if (node.has("group"))
    entry.group = node.text(
        {"group", "", "medians and spread of fits of one group are printed too; absent: the name"});
  for (const config::Node& recording :
       node.list({"recordings", "", "that determine the parameters together; see each `kind`"}))
    entry.recordings.push_back(recording.dump());
  if (entry.recordings.empty()) node.fail("recordings", "must hold one or more");
  entry.parameters = node.dump("parameters");
  entry.each = node.text(
      {"each", "", "one fit for each number in this column of the first recording's file"}, "");
  if (is_in_list && node.has("variants"))
    entry.variants = node.texts({"variants", "", "only these; absent: all"});
  node.leave_to_another("recordings");
  node.leave_to_another("parameters");
  return entry;
}

std::string short_number(double value) { return common::formatted("%g", value); }

}  // namespace

std::string Job::title() const { return variant.empty() ? name : name + ", " + variant; }

Plan read_plan(const config::Node& node, const std::filesystem::path& data) {
  Plan plan;
  plan.name = node.text({"name", "", "of the plan"});
  plan.about = node.text({"about", "", "how it is done, printed above the results"}, "");
  plan.hash = std::to_string(node.hash());
  const config::Node nothing = config::Node::from_text("{}", plan.name);
  const config::Node common = laid_over(nothing, node.dump("recording"), plan.name);
  const config::Node solver = laid_over(nothing, node.dump("solver"), plan.name);
  const config::Node parameters = laid_over(nothing, node.dump("parameters"), plan.name);
  for (const char* key : {"recording", "solver", "parameters"}) node.leave_to_another(key);
  const double effective_strain =
      node.child_or_empty({"effective", "", "the co-rotational material that comes nearest"})
          .number({"strain", "", "its greatest strain; 0: all that is fitted"}, {1e-6, 100}, 0);
  const std::vector<Variant> variants = read_variants(node);
  std::vector<Entry> entries;
  std::set<std::string> names;
  for (const config::Node& entry :
       node.list({"fits", "", "each by itself; absent: one fit of the plan's own `recordings`"})) {
    entries.push_back(read_entry(entry, entry.text({"name", "", "of the fit"}), true));
    if (!names.insert(entries.back().name).second) entry.fail("name", "comes twice");
  }
  if (entries.empty()) entries.push_back(read_entry(node, plan.name, false));
  node.check_all_used();

  for (const Variant& variant : variants) {
    const config::Node settings = under("solver", laid_over(solver, variant.solver, plan.name),
                                        plan.name, plan.name + ": solver");
    const FitOptions options =
        read_solver(settings.child_or_empty({"solver", "", "how the fits are done"}), {});
    settings.check_all_used();
    for (const Entry& entry : entries) {
      if (!entry.has(variant.name)) continue;
      const std::string place = plan.name + ": " + entry.name;
      const config::Node changes = under(
          "parameters",
          laid_over(laid_over(parameters, entry.parameters, place), variant.parameters, place),
          plan.name, place);
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
