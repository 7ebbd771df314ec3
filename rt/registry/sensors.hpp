#pragma once

#include "core/sensing/biotac_geometry.hpp"
#include "core/sensing/payload.hpp"
#include "rt/registry/registry.hpp"

// Sensor models of several files, and the keys that they have in common.
namespace palpate::registry {

/// Declares `polarity`: -1 or 1, which the components check.
template <class Options>
config::OptionTable<Options> polarity_options() {
  return config::OptionTable<Options>().integer(
      "polarity",
      "Sign of the readings: -1 for a sensor that reports its load's reaction, or whose counts "
      "fall under pressure; else 1",
      {-1, 1}, &Options::polarity);
}

/// Keys of any sensor model.
template <class Options>
config::OptionTable<Options> sensor_options() {
  return config::OptionTable<Options>()
      .integer("tare_samples", "Number of readings averaged by a tare", {1, 100000},
               &Options::tare_samples)
      .number("max_age_ms", "ms", "Age of the latest reading beyond which the model is degraded",
              {1, 1e4}, &Options::max_age, 1e-3)
      .number("force_deviation", "N",
              "Standard deviation of each axis of the output, the weight of which it determines in "
              "estimators",
              {0, 100}, &Options::force_deviation);
}

/// Keys of wrist sensors.
template <class Options>
config::OptionTable<Options> wrist_options() {
  return sensor_options<Options>()
      .number("torque_deviation", "N m",
              "Standard deviation of each axis of the torque about the origin of S, published on "
              "WRENCH_COMPENSATED",
              {0, 100}, &Options::torque_deviation)
      .flag("tare_at_start",
            "Tare at the start and after a reset, during which nothing may be held",
            &Options::tare_at_start)
      .part(polarity_options<Options>());
}

/// Keys of the location of a contact on a fingertip.
inline config::OptionTable<sensing::LocalizationOptions> localization_options() {
  using Options = sensing::LocalizationOptions;
  return polarity_options<Options>()
      .number("threshold", "counts", "Change of an electrode above which it is active", {0, 4095},
              &Options::threshold)
      .number("saturation", "counts", "Change of an electrode of full intensity", {1, 4095},
              &Options::saturation)
      .choice<sensing::Weighting>(
          "weighting",
          "Location of a contact from the intensities: their centroid, or as published in the "
          "thesis",
          {{"centroid", sensing::Weighting::kCentroid},
           {"published", sensing::Weighting::kPublished}},
          &Options::weighting);
}

/// Keys of fingertips.
template <class Options>
config::OptionTable<Options> fingertip_options() {
  return sensor_options<Options>()
      .integer("finger", "Index of the fingertip: channel BIOTAC_n", {0, 4}, &Options::finger)
      .part(localization_options(), &Options::localization)
      .number("contact_force", "N", "Force above which a contact begins", {0, 100},
              &Options::contact_force)
      .number("release_force", "N", "Force below which a contact ends", {0, 100},
              &Options::release_force);
}

/// Section `payload`. Throws config::Error.
sensing::PayloadParameters read_payload(const config::Node& node);

/// Component `biotac_lstm` of the sensing slot, or that and its fallback. Throws config::Error,
/// also for a model that cannot be used, naming its file and the reason.
std::unique_ptr<sensing::SensorModel> make_biotac_lstm(const config::Node& node,
                                                       const Context& context);

/// Component `ft_rnnob`. Throws as above.
std::unique_ptr<sensing::SensorModel> make_ft_rnnob(const config::Node& node,
                                                    const Context& context);

/// Component `joint_torque`, of the arm in the section `robot`. Throws config::Error.
std::unique_ptr<sensing::SensorModel> make_joint_torque(const config::Node& node,
                                                        const Context& context);

/// Component `biotac_linear`, whose model is in this section or in the file named by the key
/// `file_key`.
std::unique_ptr<sensing::SensorModel> make_biotac_linear(const config::Node& node,
                                                         const std::string& file_key);

/// Frames of the arm to which the sensor belongs.
inline const Frames& frames_of(const config::Node& node, const Context& context) {
  return read_arm(node, context) == 1 ? *context.second_frames : context.frames;
}

}  // namespace palpate::registry
