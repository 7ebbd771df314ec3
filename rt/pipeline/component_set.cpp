#include "rt/pipeline/component_set.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>
#include <vector>

#include "rt/plugin/plugin.hpp"
#include "rt/registry/fallbacks.hpp"

namespace palpate::pipeline {
namespace {

const config::Key kFallback("fallback", "",
                            "what stands in where this one errs, as its slot's own");

/// Sources served by a contact instance, from the words of its list `sources`.
std::array<bool, 8> read_sources(const config::Node& node) {
  std::array<bool, 8> served{};
  const std::string text =
      node.choice({"sources", "", "whose contacts this instance takes"},
                  {"wrist", "second_wrist", "fingers", "manual", "all"}, "all");
  const bool all = text == "all";
  if (all || text == "wrist") served[0] = true;
  if (all || text == "second_wrist") served[1] = true;
  if (all || text == "fingers") std::fill(served.begin() + 2, served.begin() + 7, true);
  if (all || text == "manual") served[7] = true;
  return served;
}

}  // namespace

bool senses_only(const config::Node& root) {
  constexpr const char* kOfObject[] = {"object",      "obstacles", "contact", "estimation",
                                       "deformation", "feature",   "control"};
  const auto has = [&root](const char* key) { return root.has(key); };
  return std::none_of(std::begin(kOfObject), std::end(kOfObject), has) && root.has("sensing");
}

Changes Changes::all(const config::Node& root) {
  const bool rest = !senses_only(root);
  Changes changes{rest, rest, rest, rest, {}};
  changes.sensing.assign(root.list({"sensing", "", "sensor models, at most 16"}).size(), true);
  return changes;
}

bool Changes::any() const noexcept {
  return object || contact || mechanics || steering ||
         std::find(sensing.begin(), sensing.end(), true) != sensing.end();
}

ComponentSet::ComponentSet(const config::Node& root, const registry::Context& cell,
                           const Changes& changes, std::shared_ptr<const registry::Object> present)
    : object(std::move(present)), context(cell) {
  const int abandoned = plugin::abandoned_calls();
  try {
    build(root, changes);
  } catch (...) {
    if (plugin::abandoned_calls() != abandoned) keep_for_ever();
    throw;
  }
}

void ComponentSet::build(const config::Node& root, const Changes& changes) {
  if (changes.object)
    object = std::make_shared<registry::Object>(
        registry::read_object(root, context.frames, context.remarks));
  if (!object) object = std::make_shared<registry::Object>();
  context.object = object.get();
  build_sensing(root, changes);
  if (changes.contact) build_contact(root);
  if (changes.mechanics) {
    const config::Node mechanics =
        root.child({"deformation", "", "how the object deforms under grasp and loads"});
    const config::Node driver =
        root.child({"estimation", "", "what drives and corrects the deformation"});
    mechanics.leave_to_another("fallback");
    driver.leave_to_another("fallback");
    model = registry::make_deformation_model(mechanics, context);
    estimator = registry::make_estimator(driver, context);
    shape_watch = ShapeWatch(*object);
  }
  if (changes.steering) build_steering(root);
}

void ComponentSet::make_model(const config::Node& node, Sensing& instance) {
  if (!registry::has_fallback(node)) {
    instance.model = registry::make_sensor_model(node, context);
    return;
  }
  registry::check_sensor(node, context);
  registry::check_differs(node);
  auto pair = std::make_unique<registry::SensorFallback>(
      registry::make_sensor_model(node, context),
      registry::make_sensor_model(node.child(kFallback), context), nullptr);
  instance.fallback = pair.get();
  instance.model = std::move(pair);
}

void ComponentSet::make_transformer(const config::Node& node, Contact& instance) {
  if (!registry::has_fallback(node)) {
    instance.transformer = registry::make_force_transformer(node, context);
    return;
  }
  registry::check_differs(node);
  auto transformer = std::make_unique<registry::ContactFallback>(
      registry::make_force_transformer(node, context),
      registry::make_force_transformer(node.child(kFallback), context));
  instance.fallback = transformer.get();
  instance.transformer = std::move(transformer);
}

void ComponentSet::build_sensing(const config::Node& root, const Changes& changes) {
  std::size_t index = 0;
  if (root.list({"sensing", "", "sensor models, at most 16"}).size() > kMostSensors)
    root.fail("sensing", "more than " + std::to_string(kMostSensors) + " sensor models");
  for (const config::Node& node : root.list({"sensing", "", "sensor models, at most 16"})) {
    Sensing instance;
    instance.component = node.text({"component", "", "model of the sensor"});
    instance.name = node.text(
        {"name", "", "of the instance, in events and for replacement; by default the component"},
        instance.component);
    instance.arm = registry::read_arm(node, context);
    instance.is_wrist =
        registry::sensor_kind(instance.component, context) == plugin::SensorKind::kWrist;
    instance.reads_joints = instance.component == "joint_torque";
    if (changes.sensing[index++]) {
      make_model(node, instance);
      list_running_models(instance);
    }
    sensing.push_back(std::move(instance));
  }
}

void ComponentSet::list_running_models(const Sensing& instance) {
  for (int i = 0; const sensing::Executor* executor = instance.model->executor(i); ++i)
    running_models.push_back({instance.name + (i == 0 ? "" : "/" + std::to_string(i)), executor});
}

void ComponentSet::build_contact(const config::Node& root) {
  int max_nodes = 0;
  for (const config::Node& node :
       root.list({"contact", "", "what maps contacts to loads of nodes"})) {
    Contact instance;
    instance.name = node.text(
        {"name", "", "of the instance, in events and for replacement; by default the component"},
        node.text("component"));
    instance.sources = read_sources(node);
    make_transformer(node, instance);
    max_nodes = std::max(max_nodes, instance.transformer->max_nodes());
    contact.push_back(std::move(instance));
  }
  loads.resize(sensing::ContactSet().contacts.size());
  for (contact::ContactLoads& of_contact : loads) of_contact.loads.reserve(max_nodes);
}

void ComponentSet::build_steering(const config::Node& root) {
  for (const char* slot : {"feature", "control"}) root.child(slot).leave_to_another("fallback");
  const config::Node control =
      root.child({"control", "", "how it is steered: a Jacobian and a law"});
  feature =
      registry::make_feature(root.child({"feature", "", "what of the shape is steered"}), context);
  provider = registry::make_jacobian_provider(control, context, *feature);
  markers = registry::make_marker_observer(control, context, *feature);
  law = registry::make_control_law(control, context, *feature);
  guarded_motion = dynamic_cast<control::GuardedMotion*>(law.get());
  moving = registry::read_moving_arms(control, context);
  commands_joints = registry::read_commands_joints(control, context);
  on_discrepancy = registry::read_discrepancy_policy(control);

  const int dimension = feature->dimension();
  feature_state.value = Eigen::VectorXd::Zero(feature->value_count());
  feature_state.error = Eigen::VectorXd::Zero(dimension);
  feature_state.unreachable = Eigen::VectorXd::Zero(dimension);
  target.value = Eigen::VectorXd::Zero(feature->value_count());
  jacobian = Eigen::MatrixXd::Zero(dimension, moving == registry::MovingArms::kBoth ? 12 : 6);
  law_output.unreachable = Eigen::VectorXd::Zero(dimension);
  if (commands_joints) law_output.joint_velocity.setZero(context.arm_model->limits.count());
}

void ComponentSet::warm_up() {
  if (!model) return;
  const plugin::SetupScope scope;
  model->prepare();
  check_warm_up(scope);
  estimator->activate(*model);
  check_warm_up(scope);
  while (elasticity::Refactorisation* job = model->wanted_refactorisation()) {
    job->run();
    model->install(*job);
    if (model->step(context.period).status != elasticity::StepStatus::kFailed) break;
  }
  if (feature) feature->evaluate(model->positions(), feature_state.value);
  check_warm_up(scope);
}

void ComponentSet::check_warm_up(const plugin::SetupScope& scope) {
  if (scope.failure().empty()) return;
  keep_for_ever();
  throw config::Error("warm-up: " + scope.failure());
}

/// A thread that was abandoned may use the components until the process ends.
void ComponentSet::keep_for_ever() {
  static std::mutex mutex;
  static auto* const kept = new std::vector<std::unique_ptr<ComponentSet>>();
  const std::lock_guard<std::mutex> lock(mutex);
  kept->push_back(std::make_unique<ComponentSet>(std::move(*this)));
}

void ComponentSet::adopt(ComponentSet& other, const Changes& changes,
                         const std::vector<int>& successors) noexcept {
  for (std::size_t i = 0; i < sensing.size(); ++i) {
    if (successors[i] < 0) continue;
    Sensing& before = other.sensing[successors[i]];
    sensing[i].condition = before.condition;
    if (!sensing[i].model) {
      sensing[i].model.swap(before.model);
      std::swap(sensing[i].fallback, before.fallback);
      sensing[i].fallback_reported = before.fallback_reported;
    } else if (before.condition.state == LifeCycle::kFaulted) {
      sensing[i].condition = {LifeCycle::kActive, ""};  // a valid component has replaced it
    }
  }
  if (!changes.contact) {
    contact.swap(other.contact);
    loads.swap(other.loads);
  }
  estimate = changes.mechanics ? other.estimate.handed_over() : other.estimate;
  estimation_condition = other.estimation_condition;
  feature_condition = other.feature_condition;
  control_condition = other.control_condition;
  if (!changes.mechanics) {
    model.swap(other.model);
    estimator.swap(other.estimator);
    std::swap(shape_watch, other.shape_watch);
  } else if (estimation_condition.state == LifeCycle::kFaulted) {
    estimation_condition = {LifeCycle::kActive, ""};
  }
  if (!changes.steering) {
    feature.swap(other.feature);
    provider.swap(other.provider);
    law.swap(other.law);
    std::swap(guarded_motion, other.guarded_motion);
    markers.swap(other.markers);
    moving = other.moving;
    commands_joints = other.commands_joints;
    on_discrepancy = other.on_discrepancy;
    target.value.swap(other.target.value);
    target.revision = other.target.revision;
    feature_state.value.swap(other.feature_state.value);
    feature_state.error.swap(other.feature_state.error);
    feature_state.unreachable.swap(other.feature_state.unreachable);
    jacobian.swap(other.jacobian);
    std::swap(law_output, other.law_output);
    return;
  }
  for (Condition* condition : {&feature_condition, &control_condition})
    if (condition->state == LifeCycle::kFaulted) *condition = {LifeCycle::kActive, ""};
  on_discrepancy.take_over(other.on_discrepancy);
  law->reset();
  feature->evaluate(model->positions(), feature_state.value);
  const char* reason = "";
  const std::vector<Eigen::Vector3d>& points = other.feature->rest_points();
  static_assert(sizeof(Eigen::Vector3d) == sizeof(double[3]));
  set_target(other.target.revision, other.feature->kind(),
             reinterpret_cast<const double(*)[3]>(points.data()), static_cast<int>(points.size()),
             other.target.value.data(), static_cast<int>(other.target.value.size()), reason);
}

void ComponentSet::start() noexcept {
  estimation_condition = feature_condition = control_condition = {LifeCycle::kActive, ""};
  for (Sensing& instance : sensing) instance.condition = {LifeCycle::kActive, ""};
  for (Contact& instance : contact) instance.condition = {LifeCycle::kActive, ""};
  shape_watch.forget();
  on_discrepancy.reset();
  law->reset();
  provider->reset();
}

void ComponentSet::reset() noexcept {
  for (Sensing& instance : sensing) {
    instance.model->reset();
    instance.fallback_reported = false;
  }
  for (Contact& instance : contact) {
    if (instance.fallback != nullptr) instance.fallback->reset();
    instance.fallback_reported = false;
  }
  if (!model) return;
  estimator->reset();
  model->reset();
  shape_watch.forget();
  estimator->activate(*model);
  law->reset();
  provider->reset();
  if (markers) markers->reset();
  target.revision = -1;
}

bool ComponentSet::set_target(int revision, const char* kind, const double (*rest_points)[3],
                              int point_count, const double* values, int value_count,
                              const char*& reason) noexcept {
  if (!feature) {
    reason = "there is no object to have a feature";
    return false;
  }
  if (std::strcmp(kind, feature->kind()) != 0) {
    reason = "target is for another kind of feature";
    return false;
  }
  const std::vector<Eigen::Vector3d>& points = feature->rest_points();
  if (point_count != 0 && point_count != static_cast<int>(points.size())) {
    reason = "target names another number of points than the feature has";
    return false;
  }
  for (int i = 0; i < point_count; ++i) {
    const Eigen::Map<const Eigen::Vector3d> p(rest_points[i]);
    if (!((p - points[i]).norm() < 1e-6)) {
      reason = "target names other points than the feature has";
      return false;
    }
  }
  if (!feature->is_valid_target(values, value_count)) {
    reason = "target values are not valid for the feature";
    return false;
  }
  target.value = Eigen::Map<const Eigen::VectorXd>(values, value_count);
  target.revision = revision;
  return true;
}

SensorReport ComponentSet::sensor_report(int index) const noexcept {
  const Sensing& instance = sensing[index];
  SensorReport report{instance.name.c_str(), instance.component.c_str(), instance.condition,
                      instance.model.get()};
  report.condition.component = report.name;
  return report;
}

Condition ComponentSet::worst_of(const Condition& whole) const noexcept {
  Condition worst = whole;
  const auto consider = [&worst](const Condition& other) {
    if (static_cast<int>(other.state) > static_cast<int>(worst.state)) worst = other;
  };
  for (std::size_t i = 0; i < sensing.size(); ++i)
    consider(sensor_report(static_cast<int>(i)).condition);
  for (const Contact& instance : contact) {
    Condition condition = instance.condition;
    condition.component = instance.name.c_str();
    consider(condition);
  }
  consider(estimation_condition);
  consider(shape_watch.condition());
  consider(feature_condition);
  consider(control_condition);
  return worst;
}

bool ComponentSet::on_fallback() const noexcept {
  const auto in_use = [](const auto& instance) {
    return instance.fallback != nullptr && instance.fallback->in_use();
  };
  return std::any_of(sensing.begin(), sensing.end(), in_use) ||
         std::any_of(contact.begin(), contact.end(), in_use);
}

}  // namespace palpate::pipeline
