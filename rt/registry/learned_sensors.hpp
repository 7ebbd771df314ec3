#pragma once

#include <memory>

#include "core/sensing/sensor_model.hpp"
#include "rt/registry/registry.hpp"

namespace palpate::registry {

/// Component `biotac_lstm` of the sensing slot. Keys: finger, model_file (a module of
/// palpate-train, with its model card; inputs from e1 to e19, pac0, pdc, outputs fx, fy, fz);
/// executor (torch, compiled), wait_us; localisation (nominal, gaussian, inverted_gaussian), or
/// direction_file (a module with outputs nx, ny, nz) and direction_frame ({rpy_deg: ...}, of its
/// outputs in T); polarity, threshold, saturation, weighting, tare_samples, contact_force,
/// release_force, max_age_ms, force_deviation as for biotac_linear; largest_force; fallback (none,
/// biotac_linear), active if the network fails, with fallback_file, its model. Throws
/// config::Error, also for a model that cannot be used, naming its file and the reason.
std::unique_ptr<sensing::SensorModel> make_biotac_lstm(const config::Node& node,
                                                       const Context& context);

/// Component `ft_rnnob`. Keys: model_file (inputs of observer_inputs(), outputs fx, fy, fz, tx, ty,
/// tz), executor, wait_us; payload, which overrides that of the card, or is used for the fallback
/// if the card has none; fallback (none, newton_euler); tare_samples (steps of the network),
/// tare_at_start, polarity, max_age_ms, force_deviation as for ft_newton_euler.
std::unique_ptr<sensing::SensorModel> make_ft_rnnob(const config::Node& node, const Frames& frames,
                                                    const Context& context);

/// Component `biotac_linear`, whose model is in this section or in the file named by the key
/// `file_key`.
std::unique_ptr<sensing::SensorModel> make_biotac_linear(const config::Node& node,
                                                         const std::string& file_key);

}  // namespace palpate::registry
