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
  std::vector<std::filesystem::path> models;  // none: the presets, trained on `train`
  std::filesystem::path output;               // trained models, CSV, pictures
  std::filesystem::path json;                 // empty: none
  std::string executor = "compiled";          // or torch
  bool verbose = false;
};

/// Scores every model and baseline on every recording below `data` that fits it, on rows that it
/// was not fitted to where there are such, and says what of it was seen. Presets keep their
/// validation and test parts unseen where all that is scored is found below `train`; else they
/// learn from all parts. Recordings that could not be used go to `damaged`. Throws
/// std::runtime_error where no recording fits, config::Error where a card cannot be used,
/// Interrupted.
std::vector<SensorComparison> compare_sensor_folders(const SensorsOptions& options,
                                                     std::ostream& out,
                                                     std::vector<std::string>& damaged);

/// Does so and prints, writes and draws the result; 0, or 1 where a recording of the right columns
/// could not be used.
int run_sensors(const SensorsOptions& options, std::ostream& out);

/// The command sensors.
class SensorsCommand {
 public:
  explicit SensorsCommand(CLI::App& app);
  /// Runs it where it was given and returns the exit code. `recordings`: default of --train. Throws
  /// as compare_sensor_folders.
  std::optional<int> run(const std::filesystem::path& recordings, std::ostream& out);

 private:
  SensorsOptions options_;
  CLI::App* command_;
};

}  // namespace palpate::sensor_models
