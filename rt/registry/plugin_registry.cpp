#include "rt/registry/plugin_registry.hpp"

#include "rt/plugin/plugin_guards.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {
namespace {

/// Getters with a default mark a key as read even if it is absent.
plugin::ParameterValue read(const config::Node& node, const plugin::Parameter& parameter) {
  const std::string& key = parameter.key;
  const config::Range range{parameter.lower, parameter.upper};
  const bool given = parameter.required || node.has(key);
  switch (parameter.kind) {
    case plugin::Parameter::Kind::kNumber:
      return given ? node.number(key, range)
                   : node.number(key, range, std::get<double>(parameter.otherwise));
    case plugin::Parameter::Kind::kInteger:
      return given ? node.integer(key, range)
                   : node.integer(key, range, std::get<int>(parameter.otherwise));
    case plugin::Parameter::Kind::kFlag:
      if (given && !node.has(key)) node.fail(key, "is missing; allowed: true, false");
      return node.flag(key, std::get<bool>(parameter.otherwise));
    case plugin::Parameter::Kind::kChoice:
      return given
                 ? node.choice(key, parameter.allowed)
                 : node.choice(key, parameter.allowed, std::get<std::string>(parameter.otherwise));
    case plugin::Parameter::Kind::kNumbers:
      break;
  }
  return given ? plugin::ParameterValue(node.numbers(key, parameter.count, range))
               : parameter.otherwise;
}

template <class Component>
std::unique_ptr<Component> make(const plugin::PluginEntry<Component>& entry,
                                const config::Node& node, const char* key,
                                const plugin::PluginCell& cell) {
  plugin::Parameters parameters;
  for (const plugin::Parameter& parameter : entry.parameters) {
    try {
      parameters.put(parameter.key, read(node, parameter));
    } catch (const config::Error& error) {
      throw config::Error(std::string(error.what()) + " (" + entry.name + ": " +
                          parameter.description + ")");
    }
  }
  std::unique_ptr<Component> made;
  try {
    made = entry.make(parameters, cell);
  } catch (const config::Error&) {
    throw;
  } catch (const std::exception& error) {
    node.fail(key, entry.name + ": " + error.what());
  } catch (...) {
    node.fail(key, entry.name + ": the plug-in threw something that is no std::exception");
  }
  if (!made) node.fail(key, entry.name + ": the plug-in made nothing");
  return made;
}

/// Calls a function that may throw std::invalid_argument or any exception of the plug-in.
template <class Call>
auto guarded(const config::Node& node, const char* key, const std::string& name, Call call) {
  try {
    return call();
  } catch (const std::exception& error) {
    node.fail(key, name + ": " + error.what());
  } catch (...) {
    node.fail(key, name + ": the plug-in threw something that is no std::exception");
  }
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
  return plugin::guard(make(entry, node, "component", cell));
}

std::unique_ptr<contact::ForceTransformer> make_plugin(
    const plugin::PluginEntry<plugin::PluginForceTransformer>& entry, const config::Node& node,
    const Context& context) {
  auto made = make(entry, node, "component", cell_of(context, context.frames));
  return guarded(node, "component", entry.name, [&] {
    return plugin::guard(std::move(made), context.object->body.mesh.node_count());
  });
}

std::unique_ptr<control::JacobianProvider> make_plugin(
    const plugin::PluginEntry<plugin::PluginJacobianProvider>& entry, const config::Node& node,
    const Context& context) {
  return plugin::guard(make(entry, node, "provider", cell_of(context, context.frames)));
}

std::unique_ptr<control::ControlLaw> make_plugin(
    const plugin::PluginEntry<plugin::PluginControlLaw>& entry, const config::Node& node,
    const Context& context) {
  return plugin::guard(make(entry, node, "law", cell_of(context, context.frames)));
}

}  // namespace palpate::registry
