#pragma once

#include <string>
#include <vector>

#include "rt/inference/model_card.hpp"
#include "tools/lab/sensor_models/sensors_data.hpp"

namespace palpate::sensor_models {

/// What a model was fitted to: files by their hash, and the times in each that were kept from it.
struct SensorTraining {
  struct File {
    std::string sha256;
    std::vector<recordings::Interval> validation;
    std::vector<recordings::Interval> test;
  };
  std::vector<File> files;
  bool all_parts = false;  // validation and test were learned in the end, too
  bool is_stated = true;   // false: the card says nothing of it

  /// Same files and times: what is compared on the same rows.
  bool operator==(const SensorTraining& other) const;
  const File* find(const SensorRecording& recording) const;  // nullptr where never seen
};

/// Of a card. Throws config::Error where what it says of its data cannot be read.
SensorTraining training_of(const inference::ModelCard& card);

/// Of a plan, files below `folder`; those that are absent are left out.
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

/// Rows that are wanted; rows of several recordings one below the other.
Eigen::MatrixXd wanted_rows(const Eigen::MatrixXd& rows, const std::vector<bool>& wanted);
Eigen::MatrixXd stacked(const std::vector<Eigen::MatrixXd>& parts);

}  // namespace palpate::sensor_models
