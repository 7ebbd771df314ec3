#include "rt/registry/fallback_checks.hpp"

#include <algorithm>

#include "rt/registry/plugin_registry.hpp"

namespace palpate::registry {
namespace {

/// Description of a sensor model's kind of sensor.
std::string sensor_of(const config::Node& node, const Context& context) {
  const std::string name = node.text("component");
  switch (listens_to(name, context)) {
    case Listens::kWrist:
      return "the wrist of arm " + std::to_string(read_arm(node, context));
    case Listens::kFinger:
      return "finger " + std::to_string(node.integer("finger", {0, 4}, 0));
    case Listens::kOther:
      break;
  }
  return name == "manual" || plugin::find_plugin(plugins_of(context).sensor_models, name) == nullptr
             ? "nobody's sensor"
             : "a sensor of its own, that of " + name;
}

}  // namespace

bool has_fallback(const config::Node& node) { return node.is_mapping("fallback"); }

void check_differs(const config::Node& node) {
  const config::Node fallback = node.child("fallback");
  for (const std::string& key : fallback.keys())
    if (fallback.dump(key) != node.dump(key)) return;
  for (const std::string& key : node.keys())
    if (key != "fallback" && key != "name" && key != "sources" && !fallback.has(key)) return;
  node.fail("fallback", "is the same as what it is to stand in for");
}

void check_sensor(const config::Node& node, const Context& context) {
  const config::Node fallback = node.child("fallback");
  const std::string wanted = sensor_of(node, context), given = sensor_of(fallback, context);
  if (node.text("component") == "manual")
    node.fail("fallback", "nothing stands in for manual forces");
  if (wanted == given) return;
  node.fail("fallback", fallback.text("component") + " is of " + given + ", " +
                            node.text("component") + " of " + wanted +
                            ": it cannot stand in for it");
}

void check_feature(const config::Node& node, const Context& context) {
  const config::Node fallback = node.child("fallback");
  const auto feature = make_feature(node, context), other = make_feature(fallback, context);
  const auto fail = [&](const std::string& what) {
    node.fail("fallback", what + ": the target would no longer be one of it");
  };
  if (std::string(feature->kind()) != other->kind())
    fail(std::string("is a ") + other->kind() + ", not a " + feature->kind());
  const auto &points = feature->rest_points(), &others = other->rest_points();
  const bool same = points.size() == others.size() &&
                    std::equal(points.begin(), points.end(), others.begin(),
                               [](const auto& a, const auto& b) { return (a - b).norm() < 1e-6; });
  if (!same) fail("has other rest_points than the feature");
}

}  // namespace palpate::registry
