#pragma once

#include <memory>

#include "rt/plugin/plugin_components.hpp"

namespace palpate::plugin {

/// A plug-in's component as one of the slot's own: what it throws stops here, and becomes a fault
/// of the component. Construction may throw what the component's own set-up calls throw, as
/// std::invalid_argument.
std::unique_ptr<sensing::SensorModel> guard(std::unique_ptr<PluginSensorModel> model);
/// `node_count`: of the mesh that loads name nodes of.
std::unique_ptr<contact::ForceTransformer> guard(
    std::unique_ptr<PluginForceTransformer> transformer, int node_count);
std::unique_ptr<control::JacobianProvider> guard(std::unique_ptr<PluginJacobianProvider> provider);
std::unique_ptr<control::ControlLaw> guard(std::unique_ptr<PluginControlLaw> law);

}  // namespace palpate::plugin
