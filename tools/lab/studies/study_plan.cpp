#include "tools/lab/studies/study_plan.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "rt/config/node.hpp"
#include "sim/scenes/scene.hpp"
#include "tools/common/output_files.hpp"
#include "tools/lab/runs/live_run.hpp"
#include "tools/lab/uncertainty/drawn_error.hpp"
#include "tools/lab/uncertainty/draws_command.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;

constexpr double kSettle = 0.5;  // s after the end of a scene's motion

fs::path source_file(const config::Node& node, const config::Key& key, const fs::path& root,
                     const std::string& otherwise = "") {
  const fs::path file = root / (otherwise.empty() ? node.text(key) : node.text(key, otherwise));
  if (!fs::exists(file)) node.fail(key.name, "there is no file " + file.string());
  return file;
}

std::vector<std::string> names(const config::Node& node, const config::Key& key) {
  const std::vector<std::string> texts = node.texts(key);
  if (texts.empty()) node.fail(key.name, "is empty");
  if (std::set<std::string>(texts.begin(), texts.end()).size() != texts.size())
    node.fail(key.name, "names something twice");
  return texts;
}

std::vector<runs::Method> chosen_methods(const config::Node& node, const fs::path& root) {
  const std::vector<runs::Method> known = runs::read_methods(
      source_file(node, {"method_file", "", "file of the methods, relative to palpate's folder"},
                  root, "tools/lab/studies/methods.yaml"));
  std::vector<runs::Method> chosen;
  for (const std::string& name :
       names(node, {"methods", "", "methods to run, by their names in method_file"})) {
    const auto found =
        std::find_if(known.begin(), known.end(),
                     [&name](const runs::Method& method) { return method.name == name; });
    if (found == known.end()) {
      std::string list;
      for (const runs::Method& method : known) list += (list.empty() ? "" : "; ") + method.name;
      node.fail("methods", "unknown method \"" + name + "\"; known: " + list);
    }
    chosen.push_back(*found);
  }
  return chosen;
}

/// Settings of this application, applied after those of a method or level. `is_replaced`: the
/// plan's model errors are not run, so that settings for them have no effect.
void add_settings(const config::Node& node, StudyApplication& application, bool is_replaced) {
  const auto named = [](const std::string& name) {
    return [&name](const auto& entry) { return entry.name == name; };
  };
  for (const std::string& name : node.keys()) {
    const auto method =
        std::find_if(application.methods.begin(), application.methods.end(), named(name));
    std::vector<std::vector<std::string>*> settings;
    if (method != application.methods.end()) settings.push_back(&method->overrides);
    for (runs::Mismatch& level : application.levels)
      if (level.name == name || level.family == name) settings.push_back(&level.daemon);
    if (settings.empty() && !is_replaced)
      node.fail(name, "is no method and no model error of this application");
    for (const std::string& setting : node.texts(
             {name, "", "key=value over the configuration, for this method or error alone"})) {
      if (setting.find('=') == std::string::npos)
        node.fail(name, "\"" + setting + "\" is not of the form key=value");
      for (std::vector<std::string>* of : settings) of->push_back(setting);
    }
  }
}

/// "calibrated 17" as "calibrated" and 17; without a number as 0.
std::pair<std::string, int> split_draw(const std::string& name) {
  const std::size_t space = name.find_last_of(' ');
  const std::string number = space == std::string::npos ? "" : name.substr(space + 1);
  const bool is_number =
      !number.empty() && number.size() < 7 &&
      std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number) return {name, 0};
  return {name.substr(0, space), std::stoi(number)};
}

/// Whether draw `index` is of this application's object, if the object is drawn as well.
bool holds_object(const StudyApplication& application, const uncertainty::LatinHypercube& sample,
                  int index) {
  if (application.objects == 0) return true;
  const double share = sample.at("object", index - 1);
  return static_cast<int>(share * application.objects) == application.object - 1;
}

/// The draws of a level that names a file of distributions; nothing for another.
std::optional<std::vector<runs::Mismatch>> drawn_levels(const config::Node& node,
                                                        const fs::path& root,
                                                        const std::string& name,
                                                        const uncertainty::LatinHypercube& sample,
                                                        const StudyApplication& application) {
  const auto [family, index] = split_draw(name);
  const fs::path file = uncertainty::distributions_file(root, family);
  if (!fs::exists(file)) return std::nullopt;
  if (index > sample.count() || (index == 0 && family != name))
    node.fail("mismatch", "\"" + name + "\" is not among the draws; allowed: 1 to " +
                              std::to_string(sample.count()));
  const uncertainty::Distributions distributions = uncertainty::read_distributions(file);
  std::vector<runs::Mismatch> levels;
  const int first = index > 0 ? index : 1, last = index > 0 ? index : sample.count();
  for (int i = first; i <= last; ++i)
    if (holds_object(application, sample, i))
      levels.push_back(uncertainty::draw_mismatch(distributions, sample, i, application.scene,
                                                  application.configuration));
  return levels;
}

std::vector<runs::Mismatch> chosen_levels(const config::Node& node, const fs::path& root,
                                          const StudyApplication& application,
                                          const LevelSelection& selection) {
  const fs::path file = source_file(
      node, {"mismatch_file", "", "file of the model errors, relative to palpate's folder"}, root,
      "tools/lab/studies/mismatch.yaml");
  std::vector<std::string> chosen = names(
      node, {"mismatch", "",
             "model errors, each for every method, by their names; calibrated and uncalibrated: "
             "draws from these distributions, calibrated 17: one of them"});
  int draws = node.integer({"draws", "", "number of draws of a level that is a distribution"},
                           {1, 100000}, 100);
  const int seed = node.integer({"draw_seed", "", "seed of these draws"}, {0, 1000000000}, 1);
  if (selection.draws > 0) draws = selection.draws;
  const uncertainty::LatinHypercube sample(
      static_cast<std::uint64_t>(selection.draw_seed.value_or(seed)), draws);
  if (!selection.levels.empty()) chosen = selection.levels;
  std::vector<runs::Mismatch> levels;
  for (const std::string& name : chosen) {
    std::optional<std::vector<runs::Mismatch>> drawn =
        drawn_levels(node, root, name, sample, application);
    if (!drawn)
      drawn = {runs::read_mismatch(file, name, application.scene, application.configuration)};
    for (runs::Mismatch& level : *drawn)
      if (std::none_of(levels.begin(), levels.end(),
                       [&level](const auto& other) { return other.name == level.name; }))
        levels.push_back(std::move(level));
  }
  return levels;
}

std::vector<int> seeds_of(const config::Node& node) {
  std::vector<int> seeds;
  for (const double seed :
       node.numbers({"seeds", "", "seeds of the scene's noise, one run for each"}, -1, {0, 1e9})) {
    if (seed != std::floor(seed)) node.fail("seeds", "wants whole numbers");
    seeds.push_back(static_cast<int>(seed));
  }
  if (seeds.empty()) node.fail("seeds", "is empty");
  return seeds;
}

runs::ControlTarget read_target(const config::Node& node, const std::string& name) {
  runs::ControlTarget target;
  target.name = name;
  target.kind =
      node.choice({"feature", "", "controlled feature"},
                  {"point", "points", "pose", "distance", "angle", "curvature", "fourier_contour"});
  target.rest_points =
      node.points({"rest_points", "m", "points of the feature on the rest shape, in O"});
  const bool is_place = target.kind == "point" || target.kind == "points" || target.kind == "pose";
  if (node.has("axis"))
    target.axis = node.vector3({"axis", "", "axis of the sign of an angle or curvature, in O"});
  if (target.kind == "fourier_contour") {
    target.harmonics = node.integer({"harmonics", "", "number of harmonics of a contour"}, {1, 31},
                                    target.harmonics);
    target.closed = node.flag({"closed", "", "closed contour"}, target.closed);
  }
  if (node.has("hand")) {
    if (node.has("displacement")) node.fail("displacement", "has no meaning with \"hand\"");
    const config::Node hand =
        node.child({"hand", "", "motion of the hand that would bring the feature to the target"});
    target.hand =
        runs::HandMotion{hand.vector3({"translation", "m", "translation of the hand, in O"},
                                      {-1, 1}, Eigen::Vector3d::Zero()),
                         hand.vector3({"rotation_deg", "deg", "rotation vector of the hand"},
                                      {-180, 180}, Eigen::Vector3d::Zero())};
  } else if (!is_place) {
    node.fail("hand", "is needed: a " + target.kind + " cannot be displaced");
  } else {
    target.displacement = node.vector3(
        {"displacement", "m", "offset of the target from the feature at rest"}, {-1, 1});
  }
  try {
    target.displace();
  } catch (const std::invalid_argument& error) {
    node.fail("rest_points", error.what());
  }
  return target;
}

/// Which of several objects a draw holds.
void read_object(const config::Node& node, StudyApplication& application) {
  const std::vector<double> place = node.numbers(
      {"drawn_object", "",
       "[1, 4]: this application has the first of four objects, of which each draw holds one; "
       "default: it has every draw"},
      2, {1, 100});
  application.object = static_cast<int>(place[0]);
  application.objects = static_cast<int>(place[1]);
  if (application.object != place[0] || application.objects != place[1] || place[0] > place[1])
    node.fail("drawn_object", "wants a number and how many there are");
}

/// Properties of the scene's own motion.
void read_motion(const config::Node& node, StudyApplication& application) {
  const config::Node scene = config::Node::load_file(application.scene.string());
  const auto motion = scenes::read_scene(scene).motion;
  if (motion) {
    application.duration = motion->duration() + kSettle;
    for (const config::Node& pose : scene.child("motion").list("poses"))
      application.pose_names.push_back(pose.text("name", ""));
  }
  if (motion && !node.has("duration")) return;
  application.duration = node.number(
      {"duration", "s",
       "length of a scene without its own motion; otherwise half a second more than its motion"},
      {0.5, 3600});
}

StudyApplication read_application(const config::Node& node, const fs::path& root,
                                  const LevelSelection& levels) {
  StudyApplication application;
  application.name = node.text({"name", "", "name of the application"});
  application.kind =
      node.choice({"kind", "", "score that is computed"}, {"force", "control", "tactile"});
  application.note = node.text({"note", "", "remark that is printed with the results"}, "");
  application.quick = node.flag({"quick", "", "part of a run with --quick"}, true);
  application.scene =
      source_file(node, {"scene", "", "scene of palpate-sim, relative to palpate's folder"}, root);
  application.configuration = source_file(
      node, {"configuration", "", "configuration of palpated, relative to palpate's folder"}, root);
  application.methods = chosen_methods(node, root);
  if (node.has("drawn_object")) read_object(node, application);
  application.levels = chosen_levels(node, root, application, levels);
  add_settings(
      node.child_or_empty({"also", "", "settings by method or model error, after its own"}),
      application, !levels.levels.empty());
  application.seeds = seeds_of(node);
  read_motion(node, application);
  for (const config::Node& state : node.list({"states", "", "instants that are scored separately"}))
    application.states.push_back(
        {state.text({"name", "", "name of the instant"}),
         state.number({"time", "s", "time since the start"}, {0, application.duration})});
  if (node.has("pose_points")) {
    application.pose_points = node.points(
        {"pose_points", "m", "three points of the rest shape whose pose is scored, in O"});
    if (application.pose_points.size() != 3) node.fail("pose_points", "wants three points");
  }
  if (application.kind == "control") {
    application.target = read_target(node.child({"target", "", "target of the controlled feature"}),
                                     application.name);
    if (application.target->kind == "pose")
      application.pose_points = application.target->rest_points;
  } else if (node.has("target")) {
    node.fail("target", "belongs to kind control alone");
  }
  for (const config::Node& figure :
       node.list({"published", "", "figures of a publication, printed with palpate's"}))
    application.published.push_back({figure.text({"quantity", "", "measured quantity"}),
                                     figure.text({"value", "", "value with its unit"})});
  return application;
}

bool is_named(const StudyApplication& application, const std::vector<std::string>& names) {
  return names.empty() ||
         std::any_of(names.begin(), names.end(), [&application](const std::string& name) {
           return application.name.find(name) != std::string::npos;
         });
}

std::vector<int> seeds_of(const StudyApplication& application, const StudySelection& selection) {
  if (!selection.seeds.empty()) return selection.seeds;
  if (selection.quick) return {application.seeds.front()};
  return application.seeds;
}

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

StudyJob make_job(const StudyApplication& application, const runs::Method& method,
                  const runs::Mismatch& level, int seed) {
  StudyJob job;
  job.name = common::file_name(application.name + " " + method.name + " " + level.name + " " +
                               std::to_string(seed));
  job.application = application.name;
  job.kind = application.kind;
  job.method = method.name;
  job.mismatch = level.name;
  job.family = level.family;
  job.drawn = level.drawn;
  job.seed = seed;
  job.scene = application.scene;
  job.scene_overrides = level.scene;
  job.scene_overrides.push_back("seed=" + std::to_string(seed));
  job.configuration = application.configuration;
  job.daemon_overrides = level.daemon;
  append(job.daemon_overrides, method.overrides);
  job.duration = application.duration;
  job.states = application.states;
  job.pose_names = application.pose_names;
  job.pose_points = application.pose_points;
  job.target = application.target;
  if (job.target) {
    append(job.daemon_overrides, job.target->daemon_overrides());
  } else if (!job.pose_points.empty()) {
    runs::ControlTarget watched;  // no target is sent: the pose is only reported
    watched.kind = "pose";
    watched.rest_points = job.pose_points;
    append(job.daemon_overrides, watched.daemon_overrides());
  }
  return job;
}

}  // namespace

StudyPlan read_study_plan(const fs::path& file, const fs::path& root,
                          const LevelSelection& levels) {
  const config::Node node = config::Node::load_file(file.string());
  StudyPlan plan;
  plan.octree_resolution = node.number(
      {"octree_resolution", "m", "edge of the octrees' cubes, by which shapes are compared"},
      {1e-3, 1});
  std::set<std::string> names;
  for (const config::Node& entry :
       node.list({"applications", "", "tasks to run, each with every method, error and seed"})) {
    plan.applications.push_back(read_application(entry, root, levels));
    if (!names.insert(common::file_name(plan.applications.back().name)).second)
      entry.fail("name", "\"" + plan.applications.back().name + "\" is there twice");
  }
  if (plan.applications.empty()) node.fail("applications", "is empty");
  node.check_all_used();
  return plan;
}

std::vector<StudyJob> study_jobs(const StudyPlan& plan, const StudySelection& selection) {
  for (const std::string& name : selection.applications)
    if (std::none_of(plan.applications.begin(), plan.applications.end(),
                     [&name](const StudyApplication& a) { return is_named(a, {name}); }))
      throw std::invalid_argument("no application is called \"" + name + "\"; see --list");
  std::vector<StudyJob> jobs;
  for (const StudyApplication& application : plan.applications) {
    if (!is_named(application, selection.applications)) continue;
    if (selection.quick && !application.quick) continue;
    for (const int seed : seeds_of(application, selection))
      for (const runs::Mismatch& level : application.levels)
        for (const runs::Method& method : application.methods) {
          jobs.push_back(make_job(application, method, level, seed));
          jobs.back().octree_resolution = plan.octree_resolution;
          jobs.back().real_time = selection.real_time;
        }
  }
  if (jobs.empty()) throw std::invalid_argument("the selection leaves nothing to run");
  return jobs;
}

}  // namespace palpate::studies
