#pragma once

#include <memory>

#include "rt/plugin/plugins.hpp"

namespace palpate::registry {

struct Context;

/// Components of plug-ins; empty if `context` has none.
const plugin::PluginRegistrar& plugins_of(const Context& context);

/// Creates a component with its keys from `node`. Throws config::Error, also for exceptions of the
/// plug-in.
std::unique_ptr<sensing::SensorModel> make_plugin(
    const plugin::PluginEntry<plugin::PluginSensorModel>& entry, const config::Node& node,
    const Context& context);
std::unique_ptr<contact::ForceTransformer> make_plugin(
    const plugin::PluginEntry<plugin::PluginForceTransformer>& entry, const config::Node& node,
    const Context& context);
std::unique_ptr<control::JacobianProvider> make_plugin(
    const plugin::PluginEntry<plugin::PluginJacobianProvider>& entry, const config::Node& node,
    const Context& context);
std::unique_ptr<control::ControlLaw> make_plugin(
    const plugin::PluginEntry<plugin::PluginControlLaw>& entry, const config::Node& node,
    const Context& context);

}  // namespace palpate::registry
