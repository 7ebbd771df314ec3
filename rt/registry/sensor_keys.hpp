#pragma once

#include "core/sensing/biotac_geometry.hpp"
#include "core/sensing/payload.hpp"
#include "rt/registry/registry.hpp"

// Keys common to several sensor models, each declared once. All functions throw config::Error.
namespace palpate::registry {

/// Keys tare_samples, max_age_ms (stored in s) and force_deviation of any sensor model.
template <class Options>
void read_sensor_keys(const config::Node& node, Options& options) {
  options.tare_samples = node.integer({"tare_samples", "readings", "averaged by a tare"},
                                      {1, 100000}, options.tare_samples);
  options.max_age =
      node.number({"max_age_ms", "ms", "of the latest reading, beyond which the model is degraded"},
                  {1, 1e4}, options.max_age * 1e3) *
      1e-3;
  options.force_deviation =
      node.number({"force_deviation", "N",
                   "standard deviation of each axis of the output, which estimators weigh it by"},
                  {0, 100}, options.force_deviation);
}

/// Key polarity: -1 or 1.
int read_polarity(const config::Node& node);

/// The keys of read_sensor_keys(), tare_at_start and polarity, for wrist sensors.
template <class Options>
void read_wrist_keys(const config::Node& node, Options& options) {
  read_sensor_keys(node, options);
  options.tare_at_start =
      node.flag({"tare_at_start", "",
                 "whether it tares at the start and after a reset; nothing may be held then"},
                options.tare_at_start);
  options.polarity = read_polarity(node);
}

/// Keys polarity, threshold, saturation, weighting of a fingertip.
sensing::LocalizationOptions read_localization(const config::Node& node);

/// The keys of read_sensor_keys() and read_localization(), finger, contact_force and release_force,
/// for fingertips.
template <class Options>
void read_fingertip_keys(const config::Node& node, Options& options) {
  read_sensor_keys(node, options);
  options.finger =
      node.integer({"finger", "", "which fingertip: channel BIOTAC_n"}, {0, 4}, options.finger);
  options.localization = read_localization(node);
  options.contact_force = node.number({"contact_force", "N", "above which a contact begins"},
                                      {0, 100}, options.contact_force);
  options.release_force =
      node.number({"release_force", "N", "below which it ends"}, {0, 100}, options.release_force);
}

/// Keys `payload`: mass, center_of_mass, inertia about S (xx, xy, xz, yy, yz, zz), bias (force,
/// torque).
sensing::PayloadParameters read_payload(const config::Node& node);

}  // namespace palpate::registry
