#pragma once

#include <memory>

#include "rt/plugin/plugins.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {

/// Components of plug-ins; empty if `context` has none.
const plugin::PluginRegistrar& plugins_of(const Context& context);

// Each function creates a component with its keys from `node`. Throws config::Error, also for
// exceptions of the plug-in, and for one that does not return within plugin::kSetupDeadline.

std::unique_ptr<sensing::SensorModel> make_plugin(
    const plugin::PluginEntry<plugin::PluginSensorModel>& entry, const config::Node& node,
    const Context& context);
std::unique_ptr<contact::ForceTransformer> make_plugin(
    const plugin::PluginEntry<plugin::PluginForceTransformer>& entry, const config::Node& node,
    const Context& context);
std::unique_ptr<estimation::Estimator> make_plugin(
    const plugin::PluginEntry<plugin::PluginEstimator>& entry, const config::Node& node,
    const Context& context);
std::unique_ptr<elasticity::DeformationModel> make_plugin(
    const plugin::PluginEntry<plugin::PluginDeformationModel>& entry, const config::Node& node,
    const Context& context);
std::unique_ptr<shape::Feature> make_plugin(const plugin::PluginEntry<plugin::PluginFeature>& entry,
                                            const config::Node& node, const Context& context);
/// `feature`: evaluated on the rest shape.
std::unique_ptr<control::JacobianProvider> make_plugin(
    const plugin::PluginEntry<plugin::PluginJacobianProvider>& entry, const config::Node& node,
    const Context& context, shape::Feature& feature);
std::unique_ptr<control::ControlLaw> make_plugin(
    const plugin::PluginEntry<plugin::PluginControlLaw>& entry, const config::Node& node,
    const Context& context);

}  // namespace palpate::registry
