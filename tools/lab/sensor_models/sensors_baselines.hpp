#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/sensing/biotac_geometry.hpp"
#include "tools/lab/sensor_models/sensors_training.hpp"

namespace palpate::sensor_models {

/// One prediction method.
struct SensorMethod {
  std::string name;
  bool is_model = false;  // learned, from a file; otherwise a baseline
  /// n x outputs, for every row of a track. For a wrist: everything that is not contact, up to a
  /// constant.
  std::function<Eigen::MatrixXd(const SensorTrack&)> answer;
};

/// Baselines for learned models, fitted to the rows of `known` that `training` may use: the mean
/// and a ridge regression; for directions also the classical localisation in all variants (thesis
/// 3.2), its frame aligned with the recordings' by one rotation; for a wrist the rigid payload
/// (Newton-Euler, with and without the dynamic terms) and no model at all. Empty if `known` holds
/// too few such rows.
std::vector<SensorMethod> make_baselines(SensorKind kind, const SensorTraining& training,
                                         const std::vector<SensorTrack>& known);

/// Orientation of a fingertip in the frame N of recorded directions, and settings of its
/// localisation: from centroids and directions of the training rows. Full intensity is the 99 %
/// quantile of the most pressed electrode over the rows in contact.
struct FingertipFrame {
  Eigen::Matrix3d R_NT = Eigen::Matrix3d::Identity();
  sensing::LocalizationOptions localization;
};
/// Empty if there are too few rows.
std::optional<FingertipFrame> fit_frame(const SensorTraining& training,
                                        const std::vector<SensorTrack>& known);

/// 1 if the counts of pressed electrodes rise, -1 if they fall: the sign of the electrode that
/// changes most, over the rows in contact.
double polarity_of(const std::vector<SensorTrack>& tracks);

/// The rotation that best maps the columns of `from` onto those of `to` (Kabsch 1976).
Eigen::Matrix3d rotation_between(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

}  // namespace palpate::sensor_models
