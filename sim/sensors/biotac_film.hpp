#pragma once

#include <Eigen/Core>

#include "core/sensing/biotac_geometry.hpp"

namespace palpate::sensors {

/// Depth of the fluid between skin and core at rest, m.
inline constexpr double kFilmDepth = 1.9e-3;

/// The conductive fluid between skin and core as a thin sheet in patches, and the current that
/// flows through it from each sensing electrode to the four excitation electrodes (Lin, Fishel and
/// Loeb 2013) at rest.
struct BiotacFilm {
  Eigen::Matrix3Xd points;   // m, on the skin, in T: a column a patch
  Eigen::Matrix3Xd normals;  // outward
  Eigen::VectorXd areas;     // m^2
  /// Electrodes x patches: the part of an electrode's resistance at rest that a patch makes; a row
  /// sums to 1. By Thomson's principle the resistance is, to first order in a change of depth and
  /// never below the true one, the sum of shares(i, p) * kFilmDepth / depth(p).
  Eigen::MatrixXd shares;
};

/// The one film of every BioTac.
const BiotacFilm& biotac_film();

}  // namespace palpate::sensors
