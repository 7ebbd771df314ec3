#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/sensing/biotac_geometry.hpp"
#include "sim/sensors/sensor_table.hpp"

namespace palpate::sensors {

/// Something that presses on a fingertip; T is the frame of core/sensing/biotac_geometry.hpp.
struct Touch {
  Eigen::Vector3d location_T = Eigen::Vector3d::Zero();  // m, on or near the skin
  Eigen::Vector3d force_T = Eigen::Vector3d::Zero();     // N, on the finger
  double radius = 2e-3;                                  // m, of the area of contact
};

/// Sum of the parts of the touches' forces along the skin's inward normal, N; pulling is none.
double pressing_force(const std::vector<Touch>& touches);

/// Skin of a BioTac, in the patches of BiotacFilm. A touch dents it as a foundation of springs
/// would give, spread to a bell of the touch's radius and the skin's thickness, dragged along by
/// shear, which shifts the skin about the core. The fluid keeps its volume: what is displaced lifts
/// the skin everywhere. The dent follows what presses with friction (a play, Prandtl's operator)
/// and creeps with two time constants (quasi-linear viscoelasticity, Fung 1981), so that loading
/// and unloading differ.
class BiotacSkin {
 public:
  explicit BiotacSkin(const SkinTable& table);

  /// `dt` s under these touches.
  void step(double dt, const std::vector<Touch>& touches);

  /// Depth by which the skin is pressed in, m, a patch; negative where it bulges.
  Eigen::VectorXd dent() const;

  /// The same in equilibrium with these touches, without friction.
  Eigen::VectorXd equilibrium(const std::vector<Touch>& touches) const;

  /// Resistance of each electrode over that at rest.
  sensing::ElectrodeVector resistance() const;

 private:
  SkinTable table_;
  Eigen::VectorXd played_, fast_, slow_;  // m, a patch: behind friction, creep of each kind
};

}  // namespace palpate::sensors
