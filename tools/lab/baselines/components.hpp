#pragma once

#include "rt/plugin/plugin.hpp"

namespace palpate::baselines {

/// Jacobian providers of published methods.
void add_providers(plugin::PluginRegistrar& registrar);

/// Estimators of published methods.
void add_estimators(plugin::PluginRegistrar& registrar);

/// Deformation models that serve published methods alone.
void add_deformation_models(plugin::PluginRegistrar& registrar);

}  // namespace palpate::baselines
