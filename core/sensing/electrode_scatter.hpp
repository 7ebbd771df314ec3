#pragma once

#include "core/math/random.hpp"
#include "core/sensing/biotac_geometry.hpp"

namespace palpate::sensing {

/// Where the centre of an active electrode is taken to be (thesis 3.2, Fig. 3.13).
enum class ElectrodeScatter {
  kNominal,           // where it is
  kGaussian,          // drawn about it, in its plane; the more it is pressed, the wider
  kInvertedGaussian,  // the less it is pressed, the wider
};

/// One draw: an active electrode lies in its plane at a distance whose two components are normal
/// with a variance of 0.1 + 0.9 s mm^2, s being its intensity (inverted: 1 - s). Draws for all
/// electrodes, active or not, so that each takes as many numbers of `random`.
Eigen::Matrix<double, 3, kElectrodeCount> scatter_electrodes(const ElectrodeVector& counts,
                                                             const LocalizationOptions& options,
                                                             ElectrodeScatter scatter,
                                                             math::Random& random) noexcept;

}  // namespace palpate::sensing
