#pragma once

#include <Eigen/Core>

#include "core/sensing/biotac_geometry.hpp"

namespace palpate::sensors {

/// Depth of the fluid between skin and core at rest, m.
inline constexpr double kFilmDepth = 1.9e-3;

/// The conductive fluid between skin and core as a thin sheet of patches, and the current that
/// flows through it from each sensing electrode to the four excitation electrodes (Lin, Fishel and
/// Loeb 2013) at rest.
struct BiotacFilm {
  Eigen::Matrix3Xd points;   // m, on the skin, in T: one column per patch
  Eigen::Matrix3Xd normals;  // outward
  Eigen::VectorXd areas;     // m^2
  /// Electrodes x patches: the fraction of an electrode's rest resistance contributed by a patch;
  /// rows sum to 1. The sum of shares(i, p) * kFilmDepth / depth(p) is the resistance to first
  /// order in a change of depth and, by Thomson's principle, an upper bound of it.
  Eigen::MatrixXd shares;
};

/// The film shared by every BioTac.
const BiotacFilm& biotac_film();

}  // namespace palpate::sensors
