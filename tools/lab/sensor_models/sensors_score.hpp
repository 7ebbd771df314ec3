#pragma once

#include <string>
#include <vector>

#include "tools/lab/sensor_models/sensors_baselines.hpp"
#include "tools/recordings/errors.hpp"

namespace palpate::sensor_models {

/// Tare of a wrist's errors: each recording's mean error over some of its rows is subtracted,
/// equally for every method.
enum class SensorTare { kNone, kRecording, kFirstSeconds };
inline constexpr double kFirstSeconds = 2;  // s, of kFirstSeconds

/// "", "recording mean" or "first 2 s".
std::string name_of(SensorTare tare);

/// A method on one recording, or on all recordings of a file.
struct SensorScore {
  std::string method;
  bool is_model = false;
  std::string recording;  // its name; empty: all of the file
  SensorTare tare = SensorTare::kNone;
  recordings::Errors errors;  // of the plan's output groups
};

/// Methods compared on the same rows of a file's recordings.
struct SensorComparison {
  SensorKind kind = SensorKind::kForce;
  std::string file;
  std::string origin;  // as of ScoredRows
  std::vector<std::string> recordings;
  std::vector<SensorScore>
      scores;  // per method and tare: the file's, then those of recordings if there are several
  /// Of the recording with most rows, for plots: time (s), truth and predictions of the methods,
  /// for the scored rows, with the first tare.
  Eigen::VectorXd time;
  Eigen::MatrixXd truth;
  std::vector<std::string> methods;
  std::vector<Eigen::MatrixXd> answers;
};

/// `tracks`: those of one file. Recordings without a row to score are omitted; the comparison has
/// no score if none is left.
SensorComparison compare_sensors(const std::vector<SensorTrack>& tracks,
                                 const SensorTraining& training,
                                 const std::vector<SensorMethod>& methods);

}  // namespace palpate::sensor_models
