#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/lab/sensor_models/sensors_baselines.hpp"

namespace palpate::sensor_models {

/// A trained model's file, read and found whole.
struct SensorModelFile {
  std::filesystem::path path;
  SensorKind kind = SensorKind::kForce;
  std::string name;         // of the card
  SensorTraining training;  // what the card states
  int window = 0;           // above 0: a preset of this name learns from windows of so many steps
};

/// Throws std::runtime_error naming the file where it cannot be read or its card is of no kind that
/// is scored.
SensorModelFile read_sensor_model(const std::filesystem::path& path);

/// The model within the daemon's own component (force, wrist), or what that is made of (direction;
/// and within the component where `frame` is given), fed sample by sample; and, where it learned
/// from windows, run anew on each window beside that.
/// `executor`: compiled or torch. Answering throws std::runtime_error where the model fails, and
/// config::Error where the component refuses it.
std::vector<SensorMethod> make_methods(const SensorModelFile& model, const std::string& executor,
                                       const std::optional<FingertipFrame>& frame = {});

/// Names of the presets that are scored unless models are given.
const std::vector<std::string>& default_sensor_models();
/// What a preset answers. Throws config::Error where it is none.
SensorKind kind_of_preset(const std::string& preset);

struct SensorTrainingOptions {
  std::filesystem::path data;    // folder of the recordings
  std::filesystem::path output;  // folder of the models
  bool refit = true;             // false: what the presets keep for testing stays unseen
};

/// Trains a preset by palpate-train, unless its model is there already, made by the same program of
/// the same preset and recordings. Shows progress. Nothing where a recording of the preset is
/// absent. Throws Interrupted, and std::runtime_error where training fails.
std::optional<std::filesystem::path> train_sensor_model(const std::string& preset,
                                                        const SensorTrainingOptions& options,
                                                        int position, int count);

}  // namespace palpate::sensor_models
