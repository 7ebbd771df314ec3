#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/sensing/biotac_geometry.hpp"
#include "tools/lab/sensor_models/sensors_training.hpp"

namespace palpate::sensor_models {

/// One way to answer.
struct SensorMethod {
  std::string name;
  bool is_model = false;  // learned, from a file; else a baseline
  /// n x outputs, for every row of a track. Of a wrist: all that is no contact, up to a constant.
  std::function<Eigen::MatrixXd(const SensorTrack&)> answer;
};

/// What learned models are compared with, fitted to the rows of `known` that `training` may use:
/// the mean and a ridge regression; of directions also the classical localisation in all variants
/// (thesis 3.2), its frame turned into the recordings' by one rotation; of a wrist the rigid
/// payload (Newton and Euler, with and without what moves) and no model at all. Empty where `known`
/// holds too few such rows.
std::vector<SensorMethod> make_baselines(SensorKind kind, const SensorTraining& training,
                                         const std::vector<SensorTrack>& known);

/// How a fingertip stands in the frame N of recorded directions, and what its localisation is set
/// to: from centroids and directions of the rows that may be used. Full intensity is what the most
/// pressed electrode stays below in 99 of 100 rows in contact.
struct FingertipFrame {
  Eigen::Matrix3d R_NT = Eigen::Matrix3d::Identity();
  sensing::LocalizationOptions localization;
};
/// Nothing where there are too few rows.
std::optional<FingertipFrame> fit_frame(const SensorTraining& training,
                                        const std::vector<SensorTrack>& known);

/// 1 where pressed electrodes count up, -1 where they count down: the sign of the electrode that
/// moves most, over the rows in contact.
double polarity_of(const std::vector<SensorTrack>& tracks);

/// The rotation that carries the columns of `from` nearest to those of `to` (Kabsch 1976).
Eigen::Matrix3d rotation_between(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to);

}  // namespace palpate::sensor_models
