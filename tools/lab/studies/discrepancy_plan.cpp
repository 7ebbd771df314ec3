// Reading of discrepancies.yaml.
#include <algorithm>
#include <set>

#include "rt/config/node.hpp"
#include "tools/lab/studies/discrepancy_world.hpp"
#include "tools/lab/uncertainty/draws_command.hpp"

namespace palpate::studies {
namespace {

namespace fs = std::filesystem;

DrawnRange read_range(const config::Node& node, const config::Key& key,
                      const config::Range& allowed) {
  const std::vector<double> bounds = node.numbers(key, 2, allowed);
  if (bounds[0] > bounds[1]) node.fail(key.name, "is not the least, then the most");
  return {bounds[0], bounds[1]};
}

fs::path source_file(const config::Node& node, const config::Key& key, const fs::path& root) {
  const fs::path file = root / node.text(key);
  if (!fs::exists(file)) node.fail(key.name, "there is no file " + file.string());
  return file;
}

DiscrepancyObject read_object(const config::Node& node, const std::string& name,
                              const fs::path& root) {
  DiscrepancyObject object;
  object.name = name;
  object.scene = source_file(node, {"scene", "", "scene of palpate-sim"}, root);
  object.configuration = source_file(node, {"configuration", "", "of palpated"}, root);
  object.translation = node.vector3({"translation", "m", "most of a pose, in O"}, {0, 1});
  object.rotation_deg = node.vector3({"rotation_deg", "degrees", "most of a pose"}, {0, 90});
  object.down = read_range(node, {"down", "m", "of the hand beyond a table"}, {0, 1});
  object.side = read_range(node, {"side", "m", "of the hand beyond a wall"}, {0, 1});
  object.weight = read_range(node, {"weight", "N", "of what lies on the object"}, {0, 1000});
  object.clamp_stiffness =
      read_range(node, {"clamp_stiffness", "N/m", "of a sprung clamp, logarithmic"}, {1, 1e8});
  return object;
}

DiscrepancyKind read_kind(const config::Node& node, const std::string& name) {
  constexpr config::Range kLength{0, 1};
  DiscrepancyKind kind;
  kind.name = name;
  kind.share =
      node.integer({"share", "", "of the worlds, relative to the other kinds"}, {0, 1000000});
  if (name == "table" || name == "wall" || name == "cylinder") {
    kind.clearance = read_range(node, {"clearance", "m", "to the object at rest"}, kLength);
    kind.friction = read_range(node, {"friction", "", "of Coulomb"}, {0, 10});
  }
  if (name == "cylinder")
    kind.radius = read_range(node, {"radius", "m", "of the cylinder"}, {1e-3, 1});
  if (name == "cylinder" || name == "weight")
    kind.place = read_range(node, {"place", "", "share of the object's length"}, {0, 1});
  if (name == "shifted clamp") kind.shift = read_range(node, {"shift", "m", "across"}, kLength);
  if (name == "slip" || name == "weight")
    kind.duration = read_range(node, {"duration", "s", "of it"}, {0.01, 60});
  if (name == "slip") kind.part = node.number({"part", "", "of the grasp's length"}, {0, 1});
  if (name == "stiffer half")
    kind.factor = node.number({"factor", "", "of the stiffness"}, {0.01, 100});
  return kind;
}

runs::Method read_method(const config::Node& node, const fs::path& root) {
  const std::string name = node.text({"method", "", "of methods.yaml"});
  const std::vector<runs::Method> known =
      runs::read_methods(root / "tools/lab/studies/methods.yaml");
  const auto found = std::find_if(known.begin(), known.end(),
                                  [&name](const auto& method) { return method.name == name; });
  if (found == known.end()) node.fail("method", "unknown method \"" + name + "\"");
  return *found;
}

void read_sets(const config::Node& node, DiscrepancyPlan& plan) {
  std::set<std::string> taken;
  for (const std::string& name : node.keys()) {
    std::vector<std::string>& objects = plan.sets[name] = node.texts({name, "", "its objects"});
    if (objects.empty()) node.fail(name, "is empty");
    for (const std::string& object : objects) {
      if (std::none_of(plan.objects.begin(), plan.objects.end(),
                       [&object](const auto& known) { return known.name == object; }))
        node.fail(name, "unknown object \"" + object + "\"");
      if (!taken.insert(object).second)
        node.fail(name, "\"" + object + "\" is in two sets: tuned and scored objects differ");
    }
  }
}

}  // namespace

DiscrepancyPlan read_discrepancy_plan(const fs::path& file, const fs::path& root) {
  const std::set<std::string> known_kinds{"none",         "table",        "cylinder",
                                          "wall",         "sprung clamp", "shifted clamp",
                                          "stiffer half", "slip",         "weight"};
  const config::Node node = config::Node::load_file(file.string());
  DiscrepancyPlan plan;
  plan.method = read_method(node, root);
  plan.errors = node.text({"errors", "", "distribution of the model errors, or none"});
  if (plan.errors != "none" && !fs::exists(uncertainty::distributions_file(root, plan.errors)))
    node.fail("errors", "unknown distribution \"" + plan.errors + "\"");
  const config::Node objects = node.child({"objects", "", "objects and their sizes of motion"});
  for (const std::string& name : objects.keys())
    plan.objects.push_back(read_object(objects.child(name), name, root));
  read_sets(node.child({"sets", "", "objects that are tuned on, and that are scored"}), plan);
  const config::Node kinds = node.child({"kinds", "", "of discrepancies"});
  int shares = 0;
  for (const std::string& name : kinds.keys()) {
    if (known_kinds.count(name) == 0) kinds.fail(name, "is no kind of discrepancy");
    plan.kinds.push_back(read_kind(kinds.child(name), name));
    shares += plan.kinds.back().share;
  }
  if (shares == 0) node.fail("kinds", "have no share of the worlds");
  node.check_all_used();
  return plan;
}

}  // namespace palpate::studies
