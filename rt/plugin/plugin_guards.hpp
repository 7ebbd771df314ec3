#pragma once

#include <memory>

#include "rt/plugin/plugin_components.hpp"

namespace palpate::plugin {

/// Adapts a plug-in's component to the slot's interface: exceptions are caught and become a fault
/// of the component. Construction throws what the component's own set-up calls throw, as
/// std::invalid_argument.
std::unique_ptr<sensing::SensorModel> guard(std::unique_ptr<PluginSensorModel> model);
/// `node_count`: number of nodes of the mesh to which the loads refer.
std::unique_ptr<contact::ForceTransformer> guard(
    std::unique_ptr<PluginForceTransformer> transformer, int node_count);
std::unique_ptr<control::JacobianProvider> guard(std::unique_ptr<PluginJacobianProvider> provider);
std::unique_ptr<control::ControlLaw> guard(std::unique_ptr<PluginControlLaw> law);

}  // namespace palpate::plugin
