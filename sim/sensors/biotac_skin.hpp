#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/sensing/biotac_geometry.hpp"
#include "sim/sensors/sensor_table.hpp"

namespace palpate::sensors {

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
