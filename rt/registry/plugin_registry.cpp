#include "rt/registry/plugin_registry.hpp"

#include "rt/plugin/plugin_guards.hpp"
#include "rt/plugin/supervision.hpp"

namespace palpate::registry {
namespace {

/// The value of `section.key` lies in the mapping `section` of the component.
config::OptionValue read(const config::Node& node, const config::Option& option) {
  const auto dot = option.key.find('.');
  if (dot == std::string::npos) return node.value(option);
  config::Option inner = option;
  inner.key = option.key.substr(dot + 1);
  return node.child_or_empty({option.key.substr(0, dot), "", "options of the component"})
      .value(inner);
}

/// Calls a function that may throw any exception of the plug-in.
template <class Call>
auto guarded(const config::Node& node, const char* key, const std::string& name, Call call) {
  try {
    return call();
  } catch (const config::Error&) {
    throw;
  } catch (const std::exception& error) {
    node.fail(key, name + ": " + error.what());
  } catch (...) {
    node.fail(key, name + ": the plug-in threw something that is no std::exception");
  }
}

/// Makes the component and adapts it by `adapt(component, name)`, unless it has the interface of
/// the built-in ones. `key`: the one that names it.
template <class Component, class Adapt>
std::unique_ptr<typename Component::Core> make(const plugin::PluginEntry<Component>& entry,
                                               const config::Node& node, const char* key,
                                               const plugin::PluginCell& cell, Adapt adapt) {
  std::vector<config::OptionValue> values;
  for (const config::Option& option : entry.options) {
    try {
      values.push_back(read(node, option));
    } catch (const config::Error& error) {
      throw config::Error(std::string(error.what()) + " (" + entry.name + ": " +
                          option.description + ")");
    }
  }
  const std::string name = std::string(key) + " '" + entry.name + "' of " + entry.library;
  return guarded(node, key, entry.name, [&]() -> std::unique_ptr<typename Component::Core> {
    const auto made = std::make_shared<typename plugin::PluginEntry<Component>::Made>();
    const auto construct = [made, values, cell, make = entry.make] { *made = make(values, cell); };
    if (entry.is_guarded)
      plugin::within_deadline("its construction", construct);
    else
      construct();
    const bool is_empty = std::visit([](const auto& component) { return !component; }, *made);
    if (is_empty) node.fail(key, entry.name + ": the plug-in made nothing");
    if (auto* own = std::get_if<std::unique_ptr<typename Component::Core>>(made.get()))
      return std::move(*own);
    return adapt(std::move(std::get<std::unique_ptr<Component>>(*made)), name);
  });
}

plugin::PluginCell cell_of(const Context& context, const Frames& frames) {
  plugin::PluginCell cell;
  cell.period = context.period;
  cell.deterministic = context.deterministic;
  cell.X_WO = frames.X_WO;
  cell.X_ES = frames.X_ES;
  cell.X_EI = frames.X_EI;
  cell.X_EG = frames.X_EG;
  cell.gravity_W = frames.gravity_W;
  if (context.object != nullptr) {
    cell.body = &context.object->body;
    cell.surface = &context.object->surface;
  }
  return cell;
}

plugin::PluginCell steering_cell(const config::Node& node, const Context& context) {
  plugin::PluginCell cell = cell_of(context, context.frames);
  const MovingArms moving = read_moving_arms(node, context);
  cell.moved_grasp = moving == MovingArms::kSecond ? 1 : 0;
  cell.moved_grasps = moving == MovingArms::kBoth ? 2 : 1;
  cell.commands_joints = read_commands_joints(node, context);
  return cell;
}

/// Adapts by the guard that takes component and name.
constexpr auto kGuard = [](auto component, const std::string& name) {
  return plugin::guard(std::move(component), name);
};

}  // namespace

const plugin::PluginRegistrar& plugins_of(const Context& context) {
  static const plugin::PluginRegistrar kNone;
  return context.plugins ? context.plugins->components() : kNone;
}

std::unique_ptr<sensing::SensorModel> make_plugin(
    const plugin::PluginEntry<plugin::PluginSensorModel>& entry, const config::Node& node,
    const Context& context) {
  const int arm = read_arm(node, context);
  plugin::PluginCell cell = cell_of(context, arm == 1 ? *context.second_frames : context.frames);
  cell.arm = arm;
  if (entry.sensor == plugin::SensorKind::kFinger) cell.finger = node.integer("finger", {0, 4}, 0);
  return make(entry, node, "component", cell, kGuard);
}

std::unique_ptr<contact::ForceTransformer> make_plugin(
    const plugin::PluginEntry<plugin::PluginForceTransformer>& entry, const config::Node& node,
    const Context& context) {
  return make(entry, node, "component", cell_of(context, context.frames),
              [&](auto component, const std::string& name) {
                return plugin::guard(std::move(component), name,
                                     context.object->body.mesh.node_count());
              });
}

std::unique_ptr<estimation::Estimator> make_plugin(
    const plugin::PluginEntry<plugin::PluginEstimator>& entry, const config::Node& node,
    const Context& context) {
  return make(entry, node, "component", cell_of(context, context.frames), kGuard);
}

std::unique_ptr<elasticity::DeformationModel> make_plugin(
    const plugin::PluginEntry<plugin::PluginDeformationModel>& entry, const config::Node& node,
    const Context& context) {
  return make(entry, node, "component", cell_of(context, context.frames),
              [&](auto component, const std::string& name) {
                return plugin::guard(std::move(component), name, context.object->body);
              });
}

std::unique_ptr<shape::Feature> make_plugin(const plugin::PluginEntry<plugin::PluginFeature>& entry,
                                            const config::Node& node, const Context& context) {
  return make(entry, node, "component", cell_of(context, context.frames),
              [&](auto component, const std::string& name) {
                return plugin::guard(std::move(component), name,
                                     context.object->body.mesh.node_count());
              });
}

std::unique_ptr<control::JacobianProvider> make_plugin(
    const plugin::PluginEntry<plugin::PluginJacobianProvider>& entry, const config::Node& node,
    const Context& context, shape::Feature& feature) {
  plugin::PluginCell cell = steering_cell(node, context);
  cell.feature = &feature;
  return make(entry, node, "provider", cell, [&](auto component, const std::string& name) {
    return plugin::guard(std::move(component), name, 6 * cell.moved_grasps * feature.dimension());
  });
}

std::unique_ptr<control::ControlLaw> make_plugin(
    const plugin::PluginEntry<plugin::PluginControlLaw>& entry, const config::Node& node,
    const Context& context) {
  return make(entry, node, "law", steering_cell(node, context), kGuard);
}

}  // namespace palpate::registry
