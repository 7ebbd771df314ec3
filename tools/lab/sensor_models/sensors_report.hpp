#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <vector>

#include "tools/lab/sensor_models/sensors_score.hpp"

namespace palpate::sensor_models {

/// One table per kind, with one section per file.
void print_sensors(const std::vector<SensorComparison>& comparisons, std::ostream& out);

/// One row per method, recording and tare, RFC 4180. Angles in degrees, torques in N m.
void write_sensors_csv(const std::vector<SensorComparison>& comparisons, std::ostream& out);

nlohmann::json to_json(const SensorComparison& comparison);

/// Plots truth and predictions (or errors) over time of the first learned model and the first
/// baseline, one image per comparison below `folder`; returns the images. None if one could
/// not be drawn.
std::vector<std::filesystem::path> draw_sensors(const std::vector<SensorComparison>& comparisons,
                                                const std::filesystem::path& folder);

}  // namespace palpate::sensor_models
