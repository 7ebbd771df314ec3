#include "tools/lab/runs/experiments.hpp"

#include <yaml-cpp/yaml.h>

#include <sstream>

#include "rt/config/node.hpp"
#include "tools/lab/runs/absolute_override.hpp"
#include "tools/lab/runs/feature_on_points.hpp"

namespace palpate::runs {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const YAML::Node& at,
                       const std::string& what) {
  const int line = at.IsDefined() ? at.Mark().line + 1 : 0;
  throw config::Error(file.string() + ":" + std::to_string(line) + ": " + what);
}

YAML::Node load(const std::filesystem::path& file) {
  try {
    return YAML::LoadFile(file.string());
  } catch (const YAML::Exception& error) {
    throw config::Error(file.string() + ": " + error.what());
  }
}

std::vector<std::string> overrides(const std::filesystem::path& file, const YAML::Node& list,
                                   const std::string& level, const std::string& whose) {
  if (!list) return {};
  if (!list.IsSequence()) fail(file, list, level + "." + whose + ": wants a list of key=value");
  std::vector<std::string> texts;
  for (const YAML::Node& item : list) {
    if (!item.IsScalar() || item.Scalar().find('=') == std::string::npos)
      fail(file, item, level + "." + whose + ": an item is not of the form key=value");
    texts.push_back(item.Scalar());
  }
  return texts;
}

std::string text_of(const Eigen::Vector3d& p) {
  std::ostringstream text;
  text << '[' << p.x() << ", " << p.y() << ", " << p.z() << ']';
  return text.str();
}

/// A level as in the file: its inherited overrides, then its own.
Mismatch raw_level(const std::filesystem::path& file, const YAML::Node& root,
                   const std::string& level) {
  std::string known;
  for (const auto& entry : root) known += (known.empty() ? "" : ", ") + entry.first.Scalar();
  const YAML::Node node = root[level];
  if (!node) fail(file, root, "unknown level of mismatch \"" + level + "\"; known: " + known);
  for (const auto& entry : node) {
    const std::string key = entry.first.Scalar();
    if (key != "about" && key != "of" && key != "scene" && key != "daemon")
      fail(file, entry.first, level + "." + key + ": unknown key; known: about, of, scene, daemon");
  }
  Mismatch mismatch{level, node["about"].as<std::string>(""), {}, {}, {}, {}};
  const auto append = [](std::vector<std::string>& to, const std::vector<std::string>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const YAML::Node& part : node["of"]) {
    if (root[part.Scalar()]["of"]) fail(file, part, level + ".of: levels of levels are not known");
    const Mismatch other = raw_level(file, root, part.Scalar());
    append(mismatch.scene, other.scene);
    append(mismatch.daemon, other.daemon);
  }
  append(mismatch.scene, overrides(file, node["scene"], level, "scene"));
  append(mismatch.daemon, overrides(file, node["daemon"], level, "daemon"));
  return mismatch;
}

}  // namespace

Mismatch read_mismatch(const std::filesystem::path& file, const std::string& level,
                       const std::filesystem::path& scene,
                       const std::filesystem::path& configuration) {
  Mismatch mismatch = raw_level(file, load(file), level);
  const auto resolve = [&](std::vector<std::string>& items, const std::filesystem::path& changed) {
    for (std::string& item : items) try {
        item = absolute_override(item, changed);
      } catch (const config::Error& error) {
        throw config::Error(file.string() + ": " + level + ": " + error.what());
      }
  };
  resolve(mismatch.scene, scene);
  resolve(mismatch.daemon, configuration);
  return mismatch;
}

std::vector<Method> read_methods(const std::filesystem::path& file) {
  std::vector<Method> methods;
  for (const auto& entry : load(file)) {
    const std::string name = entry.first.Scalar();
    methods.push_back({name, overrides(file, entry.second, name, "overrides")});
  }
  if (methods.empty()) throw config::Error(file.string() + ": names no method");
  return methods;
}

void ControlTarget::displace() {
  const FeatureOnPoints feature(*this);
  values = feature.value(feature.rest_points());
  if (kind != "point" && kind != "points" && kind != "pose") return;
  const Eigen::Index points = kind == "points" ? values.size() / 3 : 1;
  for (Eigen::Index i = 0; i < points; ++i) values.segment<3>(3 * i) += displacement;
}

std::vector<std::string> ControlTarget::daemon_overrides() const {
  std::string points;
  for (const Eigen::Vector3d& point : rest_points)
    points += (points.empty() ? "" : ", ") + text_of(point);
  std::vector<std::string> overrides{"feature.component=" + kind,
                                     "feature.rest_points=[" + points + "]"};
  if (axis) overrides.push_back("feature.axis=" + text_of(*axis));
  if (kind != "fourier_contour") return overrides;
  std::string axes;
  for (const int component : components)
    axes += (axes.empty() ? "" : ", ") + std::to_string(component);
  overrides.push_back("feature.harmonics=" + std::to_string(harmonics));
  overrides.push_back(std::string("feature.closed=") + (closed ? "true" : "false"));
  overrides.push_back("feature.components=[" + axes + "]");
  return overrides;
}

std::vector<ControlTarget> read_targets(const std::filesystem::path& file) {
  const config::Node root = config::Node::load_file(file.string());
  const config::Node features = root.child("features");
  std::vector<ControlTarget> targets;
  for (const config::Node& node : root.list("targets")) {
    ControlTarget target;
    target.name = node.text("name");
    target.kind = node.choice("feature", features.keys());
    target.rest_points = features.child(target.kind).points("rest_points");
    target.displacement = node.vector3("displacement", {-1, 1});
    target.displace();
    targets.push_back(target);
  }
  root.check_all_used();
  return targets;
}

}  // namespace palpate::runs
