#include "rt/pipeline/replacement.hpp"

#include <algorithm>
#include <initializer_list>
#include <set>

#include "rt/registry/fallbacks.hpp"

namespace palpate::pipeline {
namespace {

/// Remarks are collected at start-up only; they must not be read while another thread writes.
registry::Context without_remarks(registry::Context context) {
  context.remarks = nullptr;
  return context;
}

/// Limit of the distance of the new mesh from the present one, relative to the latter's size:
/// anything farther belongs to another object, whose shape is unknown.
constexpr double kReach = 0.02;
constexpr int kWarmUpRounds = 4;

struct Place {
  std::string path;
  std::string name;  // name of the instance in the configuration; empty: none
};

Place place_of(const config::Node& root, const ReplaceRequest& request) {
  if (request.slot != "sensing" && request.slot != "contact") return {request.slot, ""};
  const std::vector<config::Node> items = root.list(request.slot);
  std::string names;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string name = items[i].text("name", items[i].text("component"));
    names += (i == 0 ? "" : ", ") + name;
    if (name == request.instance || (request.instance.empty() && items.size() == 1))
      return {request.slot + "." + std::to_string(i), name};
  }
  throw config::Error("replace: instance '" + request.instance + "' is not in slot " +
                      request.slot + "; allowed: " + names);
}

std::unique_ptr<Replacement> make_replacement(const config::Node& root,
                                              std::initializer_list<const char*> slots,
                                              const ComponentSet& present,
                                              const ShapeSnapshot& snapshot) {
  config::Node wanted = root;
  bool any = false;
  for (const char* slot : slots) {
    const config::Node section = root.child(slot);
    if (!section.has("fallback")) continue;
    wanted = wanted.changed(slot, section.child("fallback").dump(), true,
                            std::string("fallback of ") + slot);
    any = true;
  }
  if (!any) return nullptr;
  return std::make_unique<Replacement>(root, wanted, present, snapshot);
}

}  // namespace

config::Node apply_request(const config::Node& root, const ReplaceRequest& request) {
  static const std::set<std::string> kSlots = {"object",      "sensing", "contact", "estimation",
                                               "deformation", "feature", "control", "all"};
  if (kSlots.count(request.slot) == 0)
    throw config::Error("replace: slot '" + request.slot +
                        "' is unknown; allowed: object, sensing, contact, estimation, "
                        "deformation, feature, control, all");
  const std::string& parameters = request.parameters;
  if (request.slot == "all") return root.changed("", parameters, false, "replace");
  const Place place = place_of(root, request);
  if (request.component.empty()) return root.changed(place.path, parameters, false, "replace");
  const config::Node whole = config::Node::from_text(parameters, "replace")
                                 .changed("", "component: " + request.component, false, "replace");
  // the name of an instance does not change
  const config::Node named =
      place.name.empty() ? whole : whole.changed("", "name: " + place.name, false, "replace");
  return root.changed(place.path, named.dump(), true, "replace");
}

Changes find_changes(const config::Node& present, const config::Node& wanted) {
  const auto differs = [&](const char* key) { return present.dump(key) != wanted.dump(key); };
  static const std::set<std::string> kReplaceable = {
      "object", "sensing", "contact", "estimation", "deformation", "feature", "control"};
  std::vector<std::string> keys = wanted.keys();
  const std::vector<std::string> before = present.keys();
  keys.insert(keys.end(), before.begin(), before.end());
  for (const std::string& key : keys)
    if (kReplaceable.count(key) == 0 && differs(key.c_str()))
      throw config::Error("replace: " + key + " stays as it is while the daemon runs");

  if (senses_only(present) != senses_only(wanted))
    throw config::Error("replace: a daemon without an object stays without one until a restart");
  Changes changes;
  changes.object = differs("object");
  changes.contact = changes.object || differs("contact");
  changes.mechanics = changes.object || differs("estimation") || differs("deformation");
  changes.steering = changes.object || differs("feature") || differs("control");
  const std::vector<config::Node> old_models = present.list("sensing");
  for (const config::Node& node : wanted.list("sensing")) {
    const std::string text = node.dump();
    changes.sensing.push_back(
        std::none_of(old_models.begin(), old_models.end(),
                     [&](const config::Node& old) { return old.dump() == text; }));
  }
  if (!changes.any() && changes.sensing.size() == old_models.size())
    throw config::Error("replace: nothing would change");
  return changes;
}

Replacement::Replacement(const config::Node& present_root, const config::Node& wanted,
                         const ComponentSet& present, const ShapeSnapshot& snapshot)
    : changes_(find_changes(present_root, wanted)),
      components_(std::make_unique<ComponentSet>(wanted, without_remarks(present.context), changes_,
                                                 present.object)) {
  name_successors(present);
  check_keys(present_root, wanted);
  if (!changes_.mechanics) return;
  if (changes_.object) prepare_transfer(*present.object);
  const auto nodes = components_->object->body.mesh.nodes.cols();
  positions_.resize(3, nodes);
  velocities_.resize(3, nodes);
  warm_up(snapshot);
}

void Replacement::name_successors(const ComponentSet& present) {
  for (const ComponentSet::Sensing& instance : components_->sensing) {
    const auto same_name = [&](const auto& other) { return other.name == instance.name; };
    const auto at = std::find_if(present.sensing.begin(), present.sensing.end(), same_name);
    const bool known = at != present.sensing.end();
    successors_.push_back(known ? static_cast<int>(at - present.sensing.begin()) : -1);
    if (instance.model) continue;
    // its learned models are transferred with it
    for (const RunningModel& running : present.running_models)
      if (running.name == instance.name || running.name.rfind(instance.name + "/", 0) == 0)
        components_->running_models.push_back(running);
  }
}

void Replacement::check_keys(const config::Node& present_root, const config::Node& wanted) const {
  for (const char* key : {"object", "estimation", "deformation", "feature", "control"})
    if (present_root.dump(key) != wanted.dump(key)) wanted.child(key).check_all_used();
  if (changes_.contact)
    for (const config::Node& node : wanted.list("contact")) node.check_all_used();
  const std::vector<config::Node> models = wanted.list("sensing");
  for (std::size_t i = 0; i < models.size(); ++i)
    if (changes_.sensing[i]) models[i].check_all_used();
}

void Replacement::prepare_transfer(const registry::Object& from) {
  const mesh::PointLocator locator(from.body.mesh);
  const Eigen::Matrix3Xd& old_nodes = from.body.mesh.nodes;
  const double size =
      (old_nodes.rowwise().maxCoeff() - old_nodes.rowwise().minCoeff()).norm() * kReach;
  const Eigen::Matrix3Xd& new_nodes = components_->object->body.mesh.nodes;
  for (int i = 0; i < new_nodes.cols(); ++i) {
    nodes_.push_back(locator.locate(new_nodes.col(i)));
    if (nodes_.back().outside > size)
      throw config::Error("replace: object: the new mesh reaches " +
                          std::to_string(nodes_.back().outside * 1e3) +
                          " mm beyond the present one, whose shape it cannot take over");
  }
  if (components_->object->body.grasps.size() != from.body.grasps.size())
    throw config::Error("replace: object: the number of grasps must stay");
}

void Replacement::warm_up(const ShapeSnapshot& snapshot) {
  const plugin::SetupScope scope;
  elasticity::DeformationModel& model = *components_->model;
  model.prepare();
  components_->check_warm_up(scope);
  for (int round = 0; round < kWarmUpRounds; ++round) {
    if (!give_shape(snapshot.positions, snapshot.velocities, snapshot.estimate))
      throw config::Error("replace: the present shape cannot be carried over");
    components_->check_warm_up(scope);
    while (elasticity::Refactorisation* job = model.wanted_refactorisation()) {
      job->run();
      model.install(*job);
    }
    if (model.step(components_->context.period).status == elasticity::StepStatus::kConverged) break;
  }
  if (components_->feature)
    components_->feature->evaluate(model.positions(), components_->feature_state.value);
  components_->check_warm_up(scope);
}

bool Replacement::give_shape(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities,
                             const estimation::Estimate& estimate) noexcept {
  bool taken = false;
  if (nodes_.empty()) {
    taken = components_->model->restore(positions, velocities);
  } else {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      positions_.col(i) = nodes_[i].interpolate(positions);
      velocities_.col(i) = nodes_[i].interpolate(velocities);
    }
    taken = components_->model->restore(positions_, velocities_);
  }
  components_->estimator->take_over(estimate, *components_->model);
  return taken;
}

Fallbacks::Fallbacks(const config::Node& root, const ComponentSet& present,
                     const ShapeSnapshot& snapshot) {
  if (senses_only(root)) return;
  mechanics.replacement = make_replacement(root, {"estimation", "deformation"}, present, snapshot);
  if (registry::has_fallback(root.child("feature"))) {
    registry::check_feature(root.child("feature"), present.context);
    registry::check_differs(root.child("feature"));
  }
  feature.replacement = make_replacement(root, {"feature"}, present, snapshot);
  steering.replacement = make_replacement(root, {"control"}, present, snapshot);
}

}  // namespace palpate::pipeline
