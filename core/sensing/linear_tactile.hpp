#pragma once

#include <vector>

#include "core/sensing/biotac_geometry.hpp"
#include "core/sensing/signals.hpp"

namespace palpate::sensing {

/// Inputs of the force map: tared counts of E1 to E19, PAC, PDC.
inline constexpr int kTactileInputCount = kElectrodeCount + 2;
using TactileInputs = Eigen::Matrix<double, kTactileInputCount, 1>;

TactileInputs tactile_inputs(const BioTac& sample) noexcept;

/// Features in which a force map is linear.
enum class TactileFeatures {
  kCounts,  // the inputs
  /// Counts u of electrodes and PDC and their products u_i u_j / |u|, i <= j: homogeneous of degree
  /// one in the force, so that the map extrapolates linearly, while its direction can vary with the
  /// location of the contact, as the skin's normal does.
  kProducts
};

inline constexpr int kMostFeatures = 20 + 20 * 21 / 2;
using FeatureVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostFeatures, 1>;

int feature_count(TactileFeatures features) noexcept;
/// Does not allocate.
FeatureVector tactile_features(TactileFeatures features, const TactileInputs& inputs) noexcept;

/// Force of a fingertip as an affine function of features of its tared counts: force = matrix *
/// features + offset; and optionally the location of the contact.
struct LinearTactileModel {
  using Matrix = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  TactileFeatures features = TactileFeatures::kCounts;
  Matrix matrix = Matrix::Zero(3, kTactileInputCount);  // N per count
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();     // N
  /// m, applied to features divided by the norm of the electrodes' counts; empty: not available
  Matrix place;

  Eigen::Vector3d force(const TactileInputs& inputs) const noexcept;
  /// Contact location on the skin, in T; valid only if `place` is not empty.
  Eigen::Vector3d location(const TactileInputs& inputs) const noexcept;
};

struct LinearTactileFitOptions {
  /// Candidate penalties of the standardised weights, per row.
  std::vector<double> penalties{1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1};
  /// Blocks of consecutive rows for cross-validation, because neighbouring rows are correlated.
  int blocks = 5;
  /// Lower bound, counts, of a channel's deviation, so that an inactive channel is not amplified
  double deviation_floor = 1;
  bool with_offset = true;  // false: zero counts give zero force
  TactileFeatures features = TactileFeatures::kCounts;
};

struct LinearTactileFit {
  LinearTactileModel model;
  double penalty = 0;                                             // selected penalty
  Eigen::Vector3d training_rms = Eigen::Vector3d::Zero();         // N per axis
  Eigen::Vector3d cross_validated_rms = Eigen::Vector3d::Zero();  // N per axis, on the omitted rows
};

/// Ridge regression with the penalty from block cross-validation. inputs: n x 21 tared counts;
/// forces: n x 3, N. Throws std::invalid_argument if sizes differ, a number is not finite, or there
/// are fewer than two rows per block.
LinearTactileFit fit_linear_tactile(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& forces,
                                    const LinearTactileFitOptions& options = {});

/// Fits `place` of `model` in the same way: places n x 3, m, in T. Throws under the same
/// conditions.
void fit_tactile_place(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& places,
                       const LinearTactileFitOptions& options, LinearTactileModel& model);

}  // namespace palpate::sensing
