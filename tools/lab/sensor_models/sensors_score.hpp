#pragma once

#include <string>
#include <vector>

#include "tools/lab/sensor_models/sensors_baselines.hpp"
#include "tools/recordings/errors.hpp"

namespace palpate::sensor_models {

/// How a wrist's errors are tared: each recording's mean error over some of its rows is taken off,
/// the same for every method.
enum class SensorTare { kNone, kRecording, kFirstSeconds };
inline constexpr double kFirstSeconds = 2;  // s, of kFirstSeconds

/// "", "recording mean" or "first 2 s".
std::string name_of(SensorTare tare);

/// A method on one recording, or on all of a file.
struct SensorScore {
  std::string method;
  bool is_model = false;
  std::string recording;  // its name; empty: all of the file
  SensorTare tare = SensorTare::kNone;
  recordings::Errors errors;  // of the plan's output groups
};

/// Methods that are compared on the same rows of a file's recordings.
struct SensorComparison {
  SensorKind kind = SensorKind::kForce;
  std::string file;
  std::string origin;  // as of ScoredRows
  std::vector<std::string> recordings;
  std::vector<SensorScore> scores;  // per method and tare: the file's, then those of recordings
                                    // where there are several
  /// Of the recording with most rows, for pictures: time (s), truth and answers of the methods, of
  /// the rows that are scored, tared as first said.
  Eigen::VectorXd time;
  Eigen::MatrixXd truth;
  std::vector<std::string> methods;
  std::vector<Eigen::MatrixXd> answers;
};

/// `tracks`: those of one file. Recordings without a row to score are left out; the comparison has
/// no score where none is left.
SensorComparison compare_sensors(const std::vector<SensorTrack>& tracks,
                                 const SensorTraining& training,
                                 const std::vector<SensorMethod>& methods);

}  // namespace palpate::sensor_models
