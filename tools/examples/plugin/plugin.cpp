// A library of a user's own components for palpated, one for each slot, and a Jacobian provider.
// README.md describes how it is built and loaded.

#include "rt/plugin/plugin.hpp"

#include "blended_model.hpp"
#include "integral_law.hpp"
#include "median_sensor.hpp"
#include "midpoint_feature.hpp"
#include "nearest_nodes.hpp"
#include "smoothed_hand.hpp"
#include "smoothed_jacobian.hpp"

namespace {

using palpate::plugin::PluginCell;

/// Makes a `Component` from its options.
template <class Component>
std::unique_ptr<Component> make(const typename Component::Options& options, const PluginCell&) {
  return std::make_unique<Component>(options);
}

/// The same for one that needs to know the object.
template <class Component>
std::unique_ptr<Component> make_for(const typename Component::Options& options,
                                    const PluginCell& cell) {
  return std::make_unique<Component>(options, *cell.body);
}

}  // namespace

PALPATE_PLUGIN(registrar) {
  using namespace example;
  registrar.sensor_models.add("ft_median", MedianSensor::table(), make<MedianSensor>,
                              palpate::plugin::SensorKind::kWrist);
  registrar.force_transformers.add("nearest_nodes", NearestNodes::table(), make_for<NearestNodes>);
  registrar.estimators.add("smoothed_hand", SmoothedHand::table(), make<SmoothedHand>);
  registrar.deformation_models.add("blended", BlendedModel::table(), make_for<BlendedModel>);
  registrar.features.add("midpoint", MidpointFeature::table(), make_for<MidpointFeature>);
  registrar.jacobian_providers.add(
      "smoothed_fem", SmoothedJacobian::table(),
      [](const SmoothedJacobian::Options& options, const PluginCell& cell) {
        return std::make_unique<SmoothedJacobian>(options, cell);
      });
  registrar.control_laws.add("integral_twist", IntegralLaw::table(), make<IntegralLaw>);
}
