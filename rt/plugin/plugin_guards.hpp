#pragma once

#include <memory>
#include <string>

#include "rt/plugin/plugin_components.hpp"

namespace palpate::plugin {

// Each function adapts a plug-in's component to the slot's interface. Exceptions, numbers that are
// not finite, wrong sizes and writes past an output, which lies between guard words, become a fault
// of the component; after an exception or such a write it is not called again before reset().
// Calls before the loop starts have a deadline (supervision.hpp). `name`: for messages. Throws what
// the component's own functions throw, and std::invalid_argument for constants that are not valid.

std::unique_ptr<sensing::SensorModel> guard(std::unique_ptr<PluginSensorModel> model,
                                            const std::string& name);
/// `node_count`: number of nodes of the mesh to which the loads refer.
std::unique_ptr<contact::ForceTransformer> guard(
    std::unique_ptr<PluginForceTransformer> transformer, const std::string& name, int node_count);
std::unique_ptr<estimation::Estimator> guard(std::unique_ptr<PluginEstimator> estimator,
                                             const std::string& name);
/// `body`: outlives the result.
std::unique_ptr<elasticity::DeformationModel> guard(std::unique_ptr<PluginDeformationModel> model,
                                                    const std::string& name,
                                                    const elasticity::Body& body);
/// Why a guarded model does not step any more, a string literal; nullptr: it does, or is built in.
const char* fault_of(const elasticity::DeformationModel& model) noexcept;
/// Evaluated on `rest`, m, the positions of all nodes of the rest shape.
std::unique_ptr<shape::Feature> guard(std::unique_ptr<PluginFeature> feature,
                                      const std::string& name, const Eigen::Matrix3Xd& rest);
/// `entries`: of the Jacobian.
std::unique_ptr<control::JacobianProvider> guard(std::unique_ptr<PluginJacobianProvider> provider,
                                                 const std::string& name, int entries);
std::unique_ptr<control::ControlLaw> guard(std::unique_ptr<PluginControlLaw> law,
                                           const std::string& name);

}  // namespace palpate::plugin
