#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "core/sensing/linear_tactile.hpp"

namespace palpate::sensor_models {

/// The linear force regression of a BioTac, fitted on the first half of a recording and scored on
/// the rest.
struct TactileForceScore {
  sensing::LinearTactileFit fit;
  int training_rows = 0;
  int test_rows = 0;
  Eigen::Vector3d test_rms = Eigen::Vector3d::Zero();  // N per axis
  double test_rms_norm = 0;                            // N, RMS of the norm of the error
  double mean_rms_norm = 0;     // N, the same of a model that always predicts the training mean
  double largest_training = 0;  // N, largest |F| in each half
  double largest_test = 0;
};

/// The force-torque ground truth and the counts are both tared by the mean of the first half
/// second; the force is expressed in the frame of the recording's force-torque sensor. `file`:
/// columns t, fx, fy, fz, pac0, pdc, e1 to e19. Throws import::CsvError.
TactileForceScore score_tactile_force(const std::filesystem::path& file);

/// Angle between the recorded contact normal and that of the skin at the point returned by
/// locate_contact.
struct LocalizationScore {
  sensing::LocalizationOptions options;
  int contacts = 0;
  double median = 0;          // rad
  double ninetieth = 0;       // rad, 90 % quantile
  double mean_direction = 0;  // rad, median for a prediction that is always the mean normal
};

/// `file`: columns log, pdc, e1 to e19, nx, ny, nz. Rows in contact (PDC 25 counts above rest) of
/// the second half are scored; only the mean normal is taken from the first half. Throws
/// import::CsvError.
LocalizationScore score_localization(const std::filesystem::path& file,
                                     const sensing::LocalizationOptions& options);

/// Options that match the sensor of biotac_normal_dir: its counts fall under pressure, by up to
/// 900.
sensing::LocalizationOptions normal_dir_localization(sensing::Weighting weighting);

/// The regression as a model_file of the component biotac_linear: section model with force_x,
/// force_y, force_z (21 numbers each, N per count of e1 to e19, pac, pdc) and offset (N).
void write_tactile_yaml(const sensing::LinearTactileModel& model, std::ostream& out);

struct TactileOptions {
  std::filesystem::path data;   // folder of the recordings
  std::filesystem::path model;  // YAML of the fitted regression; empty: none
  std::filesystem::path json;   // empty: none
};

/// Prints force error and localisation error of the available recordings and returns the exit code:
/// 0, or 1 if a bound is missed (0.03 N, 10 degrees).
int run_tactile(const TactileOptions& options, std::ostream& out);

}  // namespace palpate::sensor_models
