#pragma once

#include <vector>

#include "core/sensing/biotac_geometry.hpp"
#include "core/sensing/signals.hpp"

namespace palpate::sensing {

/// Inputs of the force map: tared counts of E1 to E19, PAC, PDC.
inline constexpr int kTactileInputCount = kElectrodeCount + 2;
using TactileInputs = Eigen::Matrix<double, kTactileInputCount, 1>;

TactileInputs tactile_inputs(const BioTac& sample) noexcept;

/// Force of a fingertip as an affine function of its tared counts: force = matrix * inputs +
/// offset.
struct LinearTactileModel {
  Eigen::Matrix<double, 3, kTactileInputCount> matrix =
      Eigen::Matrix<double, 3, kTactileInputCount>::Zero();  // N per count
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();          // N

  Eigen::Vector3d force(const TactileInputs& inputs) const noexcept {
    return matrix * inputs + offset;
  }
};

struct LinearTactileFitOptions {
  std::vector<double> penalties{1e-7, 1e-6, 1e-5, 1e-4,
                                1e-3, 1e-2, 1e-1, 1};  // of standardised weights, per row
  int blocks = 5;              // of consecutive rows, each left out once: neighbours are alike
  double deviation_floor = 1;  // counts: a channel that hardly moves must not be blown up
  bool with_offset = true;     // false: no counts give no force
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

}  // namespace palpate::sensing
