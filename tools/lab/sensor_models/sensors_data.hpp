#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/sensing/payload.hpp"
#include "tools/recordings/plan.hpp"
#include "tools/recordings/recording_table.hpp"

namespace palpate::sensor_models {

/// Output of a sensor model.
enum class SensorKind {
  kForce,      // of a fingertip: fx, fy, fz
  kDirection,  // of a fingertip's contact: unit normal nx, ny, nz
  kWrist,      // of a wrist sensor: everything that is not contact, fx to tz
};

const char* name_of(SensorKind kind);

/// How recordings of a kind are read and its linear baseline is fitted: taken from the first preset
/// of the kind.
const recordings::Plan& plan_of(SensorKind kind);

/// Index of a named input among those that a track of the kind holds; -1: absent.
int input_place(SensorKind kind, const std::string& name);

/// One recording with ground truth, as stored in its file.
struct SensorRecording {
  SensorKind kind = SensorKind::kForce;
  std::string file;    // below the folder
  std::string name;    // file, and the recording in it if it holds several
  std::string sha256;  // of the file
  /// Tactile: electrodes, PAC (0 if there is none), PDC, truth; wrist: train::wrist_columns().
  recordings::Table table;
};

struct SensorFolder {
  std::vector<SensorRecording> recordings;
  std::vector<std::string> unfit;    // file: columns that it lacks of the closest kind
  std::vector<std::string> damaged;  // file with the right columns that cannot be used, and why
};

/// Every .csv and .csv.gz below `folder` whose columns match a kind, whatever its name. A column
/// log, recording, run or trial distinguishes the recordings of a file. Throws std::runtime_error
/// if `folder` is not a folder.
SensorFolder read_sensor_folder(const std::filesystem::path& folder);

/// A recording in the form used by models, one row per sample (tactile) or per step at the plan's
/// rate (wrist).
struct SensorTrack {
  SensorRecording recording;
  Eigen::VectorXd time;      // s
  Eigen::MatrixXd input;     // n x inputs: tared counts (E1 to E19, PAC, PDC), or observer_inputs()
  Eigen::MatrixXd truth;     // n x outputs; forces of a fingertip are tared, those of a wrist raw
  std::vector<bool> counts;  // whether a row is scored: directions only during contact
  /// Tactile: the rows at rest used for taring. The first ones, unless the pressure there is not
  /// that of rest: then the quietest ones.
  Eigen::Index tare_begin = 0;
  Eigen::Index tare_rows = 0;
  std::vector<sensing::MotionSample> samples;  // wrist
  bool acceleration_has_gravity = true;        // wrist: as detected in the data
};

/// Throws std::runtime_error if the recording is too short.
SensorTrack make_track(const SensorRecording& recording);

}  // namespace palpate::sensor_models
