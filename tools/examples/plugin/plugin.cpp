// A library of a user's own components for palpated. README.md describes how it is built and
// loaded.

#include "rt/plugin/plugin.hpp"

#include "integral_law.hpp"
#include "median_sensor.hpp"

PALPATE_PLUGIN(registrar) {
  using palpate::plugin::Parameters;
  using palpate::plugin::PluginCell;
  using palpate::plugin::SensorKind;
  registrar.control_laws.push_back({"integral_twist", example::IntegralLaw::parameters(),
                                    [](const Parameters& parameters, const PluginCell&) {
                                      return std::make_unique<example::IntegralLaw>(
                                          example::IntegralLaw::read(parameters));
                                    },
                                    SensorKind::kOther});
  registrar.sensor_models.push_back({"ft_median", example::MedianSensor::parameters(),
                                     [](const Parameters& parameters, const PluginCell&) {
                                       return std::make_unique<example::MedianSensor>(
                                           example::MedianSensor::read(parameters));
                                     },
                                     SensorKind::kWrist});
}
