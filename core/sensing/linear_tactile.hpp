#pragma once

#include <vector>

#include "core/sensing/biotac_geometry.hpp"
#include "core/sensing/signals.hpp"

namespace palpate::sensing {

/// Inputs of the force map: tared counts of E1 to E19, PAC, PDC.
inline constexpr int kTactileInputCount = kElectrodeCount + 2;
using TactileInputs = Eigen::Matrix<double, kTactileInputCount, 1>;

TactileInputs tactile_inputs(const BioTac& sample) noexcept;

/// What a force map is linear in.
enum class TactileFeatures {
  kCounts,  // the inputs
  /// Counts u of electrodes and PDC and their products u_i u_j / |u|, i <= j: of the first degree
  /// in the force, so that the map goes on straight beyond what it was fitted on, but able to turn
  /// with the place of the touch, about which a skin's normal turns.
  kProducts
};

inline constexpr int kMostFeatures = 20 + 20 * 21 / 2;
using FeatureVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostFeatures, 1>;

int feature_count(TactileFeatures features) noexcept;
/// Does not allocate.
FeatureVector tactile_features(TactileFeatures features, const TactileInputs& inputs) noexcept;

/// Force of a fingertip as an affine function of features of its tared counts: force = matrix *
/// features + offset; and, where it has been fitted, where it is touched.
struct LinearTactileModel {
  using Matrix = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  TactileFeatures features = TactileFeatures::kCounts;
  Matrix matrix = Matrix::Zero(3, kTactileInputCount);  // N per count
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();     // N
  Matrix place;  // m, of features divided by the size of the electrodes' counts; empty: not known

  Eigen::Vector3d force(const TactileInputs& inputs) const noexcept;
  /// Point of the skin that is touched, in T; only where `place` is not empty.
  Eigen::Vector3d location(const TactileInputs& inputs) const noexcept;
};

struct LinearTactileFitOptions {
  std::vector<double> penalties{1e-7, 1e-6, 1e-5, 1e-4,
                                1e-3, 1e-2, 1e-1, 1};  // of standardised weights, per row
  int blocks = 5;              // of consecutive rows, each left out once: neighbours are alike
  double deviation_floor = 1;  // counts: a channel that hardly moves must not be blown up
  bool with_offset = true;     // false: no counts give no force
  TactileFeatures features = TactileFeatures::kCounts;
};

struct LinearTactileFit {
  LinearTactileModel model;
  double penalty = 0;                                             // the chosen one
  Eigen::Vector3d training_rms = Eigen::Vector3d::Zero();         // N per axis
  Eigen::Vector3d cross_validated_rms = Eigen::Vector3d::Zero();  // N per axis, rows left out
};

/// Ridge regression, penalty by cross-validation over blocks. inputs: n x 21 tared counts; forces:
/// n x 3 N. Throws std::invalid_argument where sizes differ, a number is not finite, or rows are
/// fewer than two a block.
LinearTactileFit fit_linear_tactile(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& forces,
                                    const LinearTactileFitOptions& options = {});

/// Fits `place` of `model` in the same way: places n x 3, m, in T. Throws the same.
void fit_tactile_place(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& places,
                       const LinearTactileFitOptions& options, LinearTactileModel& model);

}  // namespace palpate::sensing
