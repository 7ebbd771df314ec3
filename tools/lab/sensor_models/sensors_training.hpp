#pragma once

#include <string>
#include <vector>

#include "rt/inference/model_card.hpp"
#include "tools/lab/sensor_models/sensors_data.hpp"

namespace palpate::sensor_models {

/// Training data of a model: files by their hash, and the time intervals of each that were
/// excluded.
struct SensorTraining {
  struct File {
    std::string sha256;
    std::vector<recordings::Interval> validation;
    std::vector<recordings::Interval> test;
  };
  std::vector<File> files;
  bool all_parts = false;  // validation and test parts were used for training in the end, too
  bool is_stated = true;   // false: the card does not state it

  /// Same files and times: models compared on the same rows.
  bool operator==(const SensorTraining& other) const;
  const File* find(const SensorRecording& recording) const;  // nullptr if it was not used
};

/// Of a card. Throws config::Error if its data section cannot be read.
SensorTraining training_of(const inference::ModelCard& card);

/// Of a plan, files below `folder`; missing files are omitted.
SensorTraining training_of(const recordings::DataPlan& plan, const std::filesystem::path& folder,
                           bool all_parts);

/// Rows of a track that a fit to `training` may use.
std::vector<bool> rows_to_learn(const SensorTraining& training, const SensorTrack& track);

/// Rows of a track that are scored after it.
struct ScoredRows {
  std::vector<bool> rows;
  std::string origin;  // "unseen", "unseen blocks", "trained on" or "training not stated"
};
ScoredRows rows_to_score(const SensorTraining& training, const SensorTrack& track);

/// Selected rows; rows of several recordings are concatenated.
Eigen::MatrixXd wanted_rows(const Eigen::MatrixXd& rows, const std::vector<bool>& wanted);
Eigen::MatrixXd stacked(const std::vector<Eigen::MatrixXd>& parts);

}  // namespace palpate::sensor_models
