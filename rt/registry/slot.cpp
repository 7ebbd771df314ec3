#include "rt/registry/slot.hpp"

#include "rt/plugin/plugin_guards.hpp"
#include "rt/plugin/supervision.hpp"

namespace palpate::registry {
namespace {

/// The value of `section.key` lies in the mapping `section` of the component.
template <class Plugin>
std::vector<config::OptionValue> read(const plugin::PluginEntry<Plugin>& entry,
                                      const config::Node& node) {
  std::vector<config::OptionValue> values;
  for (config::Option option : entry.options) {
    try {
      const auto dot = option.key.find('.');
      const std::string section = option.key.substr(0, dot);
      if (dot != std::string::npos) option.key.erase(0, dot + 1);
      values.push_back((dot == std::string::npos
                            ? node
                            : node.child_or_empty({section, "", "options of the component"}))
                           .value(option));
    } catch (const config::Error& error) {
      throw config::Error(std::string(error.what()) + " (" + entry.name + ": " +
                          option.description + ")");
    }
  }
  return values;
}

template <class Plugin>
plugin::PluginCell cell_of(const plugin::PluginEntry<Plugin>& entry, const config::Node& node,
                           const Context& context) {
  plugin::PluginCell cell;
  cell.period = context.period;
  cell.deterministic = context.deterministic;
  if constexpr (std::is_same_v<Plugin, plugin::PluginSensorModel>) {
    cell.arm = read_arm(node, context);
    if (entry.sensor == plugin::SensorKind::kFinger)
      cell.finger = node.integer("finger", {0, 4}, 0);
  }
  const Frames& frames = cell.arm == 1 ? *context.second_frames : context.frames;
  cell.X_WO = frames.X_WO;
  cell.X_ES = frames.X_ES;
  cell.X_EI = frames.X_EI;
  cell.X_EG = frames.X_EG;
  cell.gravity_W = frames.gravity_W;
  if (context.object != nullptr) {
    cell.body = &context.object->body;
    cell.surface = &context.object->surface;
  }
  if constexpr (std::is_same_v<Plugin, plugin::PluginJacobianProvider> ||
                std::is_same_v<Plugin, plugin::PluginControlLaw>) {
    const MovingArms moving = read_moving_arms(node, context);
    cell.moved_grasp = moving == MovingArms::kSecond ? 1 : 0;
    cell.moved_grasps = moving == MovingArms::kBoth ? 2 : 1;
    cell.commands_joints = read_commands_joints(node, context);
  }
  return cell;
}

template <class Plugin>
std::unique_ptr<typename Plugin::Core> guarded(std::unique_ptr<Plugin> component,
                                               const std::string& name,
                                               const plugin::PluginCell& cell) {
  if constexpr (std::is_same_v<Plugin, plugin::PluginForceTransformer>)
    return plugin::guard(std::move(component), name, cell.body->mesh.node_count());
  else if constexpr (std::is_same_v<Plugin, plugin::PluginFeature>)
    return plugin::guard(std::move(component), name, cell.body->mesh.nodes);
  else if constexpr (std::is_same_v<Plugin, plugin::PluginDeformationModel>)
    return plugin::guard(std::move(component), name, *cell.body);
  else if constexpr (std::is_same_v<Plugin, plugin::PluginJacobianProvider>)
    return plugin::guard(std::move(component), name,
                         6 * cell.moved_grasps * cell.feature->dimension());
  else
    return plugin::guard(std::move(component), name);
}

}  // namespace

const plugin::PluginRegistrar& plugins_of(const Context& context) {
  static const plugin::PluginRegistrar kNone;
  return context.plugins ? context.plugins->components() : kNone;
}

template <class Plugin>
std::unique_ptr<typename Plugin::Core> make_plugin(const plugin::PluginEntry<Plugin>& entry,
                                                   const char* key, const config::Node& node,
                                                   const Context& context,
                                                   shape::Feature* feature) {
  plugin::PluginCell cell = cell_of(entry, node, context);
  cell.feature = feature;
  const std::vector<config::OptionValue> values = read(entry, node);
  try {
    const auto made = std::make_shared<typename plugin::PluginEntry<Plugin>::Made>();
    const auto construct = [made, values, cell, make = entry.make] { *made = make(values, cell); };
    if (entry.is_guarded)
      plugin::within_deadline("its construction", construct);
    else
      construct();
    const bool is_empty = std::visit([](const auto& component) { return !component; }, *made);
    if (is_empty) node.fail(key, entry.name + ": the plug-in made nothing");
    if (auto* own = std::get_if<std::unique_ptr<typename Plugin::Core>>(made.get()))
      return std::move(*own);
    return guarded(std::move(std::get<std::unique_ptr<Plugin>>(*made)),
                   std::string(key) + " '" + entry.name + "' of " + entry.library, cell);
  } catch (const config::Error&) {
    throw;
  } catch (const std::exception& error) {
    node.fail(key, entry.name + ": " + error.what());
  } catch (...) {
    node.fail(key, entry.name + ": the plug-in threw something that is no std::exception");
  }
}

template <class Plugin>
using Maker = std::unique_ptr<typename Plugin::Core>(const plugin::PluginEntry<Plugin>&,
                                                     const char*, const config::Node&,
                                                     const Context&, shape::Feature*);
template Maker<plugin::PluginSensorModel> make_plugin<plugin::PluginSensorModel>;
template Maker<plugin::PluginForceTransformer> make_plugin<plugin::PluginForceTransformer>;
template Maker<plugin::PluginEstimator> make_plugin<plugin::PluginEstimator>;
template Maker<plugin::PluginDeformationModel> make_plugin<plugin::PluginDeformationModel>;
template Maker<plugin::PluginFeature> make_plugin<plugin::PluginFeature>;
template Maker<plugin::PluginJacobianProvider> make_plugin<plugin::PluginJacobianProvider>;
template Maker<plugin::PluginControlLaw> make_plugin<plugin::PluginControlLaw>;

}  // namespace palpate::registry
