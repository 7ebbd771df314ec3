#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>

#include "core/sensing/linear_tactile.hpp"

namespace palpate::sensor_models {

/// The force and contact point regression for the simulator's BioTac, fitted on random presses of
/// it.
struct EmulatedTactileScore {
  sensing::LinearTactileFit fit;
  int rows = 0;                                        // presses, in training and in test each
  Eigen::Vector3d test_rms = Eigen::Vector3d::Zero();  // N per axis, on unseen presses
  double test_rms_norm = 0;                            // N, RMS of the norm of the error
  double place_rms = 0;                                // m, of the distance, on unseen presses
  double centroid_rms = 0;  // m, the same of the electrodes' centroid (thesis 3.2)
  double mean_rms_norm =
      0;  // N, the same of a model that always predicts the mean of the training data
};

/// Presses an emulated BioTac `presses` times for training and as often for the test, with forces
/// of up to 2 N (the reactive grasp's band and somewhat above) within the friction cone, over the
/// part of the skin that faces the object in a grasp. Forces are those on the object, in T, as
/// biotac_linear reports them. The same seed gives the same result. Throws std::invalid_argument if
/// there are too few presses to fit.
EmulatedTactileScore score_emulated_tactile(
    std::uint64_t seed, int presses,
    sensing::TactileFeatures features = sensing::TactileFeatures::kProducts);

/// Prints the errors of both kinds of features, writes the regression with product features to
/// `model` unless that is empty; exit code 0.
int run_emulated_tactile(const std::filesystem::path& model, std::ostream& out);

}  // namespace palpate::sensor_models
