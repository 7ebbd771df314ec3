#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/sensing/biotac_geometry.hpp"
#include "sim/sensors/sensor_table.hpp"

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

/// Contact on a fingertip; T is the frame of core/sensing/biotac_geometry.hpp.
struct Touch {
  Eigen::Vector3d location_T = Eigen::Vector3d::Zero();  // m, on or near the skin
  Eigen::Vector3d force_T = Eigen::Vector3d::Zero();     // N, on the finger
  double radius = 2e-3;                                  // m, radius of the contact area
};

/// Sum of the components of the contact forces along the skin's inward normal, N; pulling counts as
/// zero.
double pressing_force(const std::vector<Touch>& touches);

/// Skin of a BioTac, in the patches of BiotacFilm. A contact dents it like an elastic foundation,
/// smoothed to a bell of the contact's radius and the skin's thickness; shear shifts the skin about
/// the core. The fluid keeps its volume: displaced fluid lifts the skin everywhere. The dent
/// follows the load with friction (play operator of Prandtl) and creeps with two time constants
/// (quasi-linear viscoelasticity, Fung 1981), so that loading and unloading differ.
class BiotacSkin {
 public:
  explicit BiotacSkin(const SkinTable& table);

  /// Advances by `dt` s under these contacts.
  void step(double dt, const std::vector<Touch>& touches);

  /// Indentation of the skin per patch, m; negative for bulges.
  Eigen::VectorXd dent() const;

  /// The same in equilibrium with these contacts, without friction.
  Eigen::VectorXd equilibrium(const std::vector<Touch>& touches) const;

  /// Resistance of each electrode relative to rest.
  sensing::ElectrodeVector resistance() const;

 private:
  SkinTable table_;
  Eigen::VectorXd played_, fast_, slow_;  // m, per patch: behind friction, creep of each kind
};

}  // namespace palpate::sensors
