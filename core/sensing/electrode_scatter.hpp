#pragma once

#include "core/math/random.hpp"
#include "core/sensing/biotac_geometry.hpp"

namespace palpate::sensing {

/// Assumed position of the centre of an active electrode (Sanchez 2019, section 3.2, Fig. 3.13).
enum class ElectrodeScatter {
  kNominal,           // nominal position
  kGaussian,          // random in its plane; the spread increases with pressure
  kInvertedGaussian,  // random in its plane; the spread decreases with pressure
};

/// Draws one sample: an active electrode is displaced in its plane by two normal components with a
/// variance of 0.1 + 0.9 s mm^2, s being its intensity (inverted: 1 - s). Numbers are drawn for all
/// electrodes, active or not, so that each call consumes the same count from `random`.
Eigen::Matrix<double, 3, kElectrodeCount> scatter_electrodes(const ElectrodeVector& counts,
                                                             const LocalizationOptions& options,
                                                             ElectrodeScatter scatter,
                                                             math::Random& random) noexcept;

}  // namespace palpate::sensing
