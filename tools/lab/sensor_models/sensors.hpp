#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "tools/lab/sensor_models/sensors_score.hpp"

namespace palpate::sensor_models {

struct SensorsOptions {
  std::filesystem::path train;                // recordings that models and baselines are fitted to
  std::filesystem::path data;                 // recordings that are scored; may be the same folder
  std::vector<std::filesystem::path> models;  // empty: the presets, trained on `train`
  std::filesystem::path output;               // trained models, CSV, images
  std::filesystem::path json;                 // empty: none
  std::string executor = "compiled";          // or torch
  bool verbose = false;
};

/// Scores every model and baseline on every matching recording below `data`, on rows that it was
/// not fitted to if there are any, and reports which part of it was used in training. Presets keep
/// their validation and test parts unseen if everything scored is below `train`; otherwise they are
/// trained on all parts. Throws std::runtime_error if no recording matches, config::Error if a
/// model card cannot be used, Interrupted.
std::vector<SensorComparison> compare_sensor_folders(const SensorsOptions& options,
                                                     std::ostream& out,
                                                     std::vector<std::string>& damaged);

/// The same, and prints, writes and plots the result; 0, or 1 if a recording with the right columns
/// could not be used.
int run_sensors(const SensorsOptions& options, std::ostream& out);

/// The command sensors.
class SensorsCommand {
 public:
  explicit SensorsCommand(CLI::App& app);
  /// Runs the command if it was given and returns the exit code. `recordings`: default of --train.
  /// Throws as compare_all_sensors.
  std::optional<int> run(const std::filesystem::path& recordings, std::ostream& out);

 private:
  SensorsOptions options_;
  CLI::App* command_;
};

}  // namespace palpate::sensor_models
