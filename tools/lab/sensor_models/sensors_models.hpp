#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/lab/sensor_models/sensors_baselines.hpp"

namespace palpate::sensor_models {

/// A trained model's file, read and validated.
struct SensorModelFile {
  std::filesystem::path path;
  SensorKind kind = SensorKind::kForce;
  std::string name;         // of the card
  SensorTraining training;  // what the card states
  int window = 0;           // > 0: a preset of this name is trained on windows of this many steps
};

/// Throws std::runtime_error naming the file if it cannot be read or its card is of no kind that is
/// scored.
SensorModelFile read_sensor_model(const std::filesystem::path& path);

/// The model within the daemon's own component (force, wrist), or the parts of one (direction; and
/// within the component if `frame` is given), fed sample by sample; if it was trained on windows,
/// also evaluated from a zero state on each window. `executor`: compiled or torch. Prediction
/// throws std::runtime_error if the model fails, and config::Error if the component rejects it.
std::vector<SensorMethod> make_methods(const SensorModelFile& model, const std::string& executor,
                                       const std::optional<FingertipFrame>& frame = {});

/// Names of the presets that are scored unless models are given.
const std::vector<std::string>& default_sensor_models();
/// Output of a preset. Throws config::Error if there is no such preset.
SensorKind kind_of_preset(const std::string& preset);

struct SensorTrainingOptions {
  std::filesystem::path data;    // folder of the recordings
  std::filesystem::path output;  // folder of the models
  bool refit = true;             // false: the preset's test data stay unseen
};

/// Trains a preset by palpate-train, unless its model already exists, made by the same program from
/// the same preset and recordings. Shows progress. Empty if a recording of the preset is missing.
/// Throws Interrupted, and std::runtime_error if training fails.
std::optional<std::filesystem::path> train_sensor_model(const std::string& preset,
                                                        const SensorTrainingOptions& options,
                                                        int position, int count);

}  // namespace palpate::sensor_models
