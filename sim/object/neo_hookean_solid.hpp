#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "sim/object/element_gradients.hpp"
#include "sim/object/hexahedral_grid.hpp"
#include "sim/object/hexahedron_pack.hpp"
#include "sim/object/j2_yield.hpp"
#include "sim/object/maxwell_branches.hpp"
#include "sim/object/neo_hookean.hpp"
#include "sim/object/stiffness_field.hpp"

namespace palpate::object {

/// A region of the object with a different stiffness. Where boxes overlap the last one counts.
struct ModulusRegion {
  Box box;                   // in O, at rest
  double young_modulus = 0;  // Pa; Poisson's ratio and yield strain remain the object's own
};

/// Material of the solid.
struct SolidOptions {
  NeoHookean material;
  double viscosity = 0;  // Pa s, Kelvin-Voigt
  std::vector<MaxwellBranch> maxwell = {};
  std::optional<Yield> yield = std::nullopt;
  std::vector<ModulusRegion> regions = {};
  StiffnessFieldOptions field = {};  // multiplies the modulus, also in the regions
};

/// Stored energy and nodal forces of a compressible Neo-Hookean solid on a hexahedral grid.
///
/// Energy per rest volume (Bonet and Wood, Nonlinear Continuum Mechanics, 2nd ed., eq. 6.27):
///   Psi = mu/2 (tr F'F - 3) - mu l + lambda/2 l^2,  P = mu F + (lambda l - mu) l' cof F,
/// with l = log J. Below J = kLeastVolumeRatio the logarithm is continued by its tangent, so that
/// energy and force stay finite, consistent with each other and restoring for any F, also inverted
/// ones. 3 x 3 x 3 Gauss points; the elements are processed four at a time.
///
/// Optional: second Piola-Kirchhoff stress eta dC/dt (Kelvin-Voigt), zero in any rigid motion;
/// Maxwell branches; yield, which makes F the elastic part only; a modulus by region or
/// from a random field, used by the Gauss points, which scales everything but eta.
class NeoHookeanSolid {
 public:
  /// Volume ratio below which log J is continued linearly.
  static constexpr double kLeastVolumeRatio = 0.2;

  /// Throws std::invalid_argument.
  NeoHookeanSolid(const HexahedralGrid& grid, const SolidOptions& options);

  /// Advances to `positions`, reached `h` s after the last ones (0: a sudden jump, infinity: fully
  /// relaxed; only Maxwell branches depend on it), and adds the nodal forces (3 x node count, N)
  /// there: minus the derivative of the energy, and the viscous forces. Returns the stiffness of
  /// the most deformed point relative to rest: an estimate, at least 1, of the growth of the
  /// largest eigenvalue of the tangent stiffness.
  double add_forces(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities, double h,
                    Eigen::Matrix3Xd& forces) noexcept;

  /// Stored energy, J, of the elastic part at `positions` and of the branches at their last update.
  double energy(const Eigen::Matrix3Xd& positions) const noexcept;

  /// Reduces the stiffness of the material within the box at rest to nearly nothing (factor
  /// kCutModulus), as if cut by a knife. Throws std::invalid_argument if the box holds no Gauss
  /// point. The first cut allocates.
  void cut(const HexahedralGrid& grid, const Box& box);
  static constexpr double kCutModulus = 1e-3;

  double viscosity() const { return viscosity_; }
  double greatest_plastic_strain() const { return yield_.greatest_strain(); }

 private:
  using Moduli = std::array<Pack4d, kGaussPoints>;

  void add_viscous_stress(const ElementGradients& F, const ElementGradients& F_rate,
                          ElementGradients& P) const noexcept;
  void set_modulus(const HexahedralGrid& grid, const ModulusRegion& region);
  void vary_modulus(const HexahedralGrid& grid, const StiffnessFieldOptions& options);
  /// change(relative stiffness, rest position) of each point within the box at rest; false if there
  /// is none.
  template <class Change>
  bool change_stiffness(const HexahedralGrid& grid, const Box& box, Change change);

  NeoHookean material_;
  double viscosity_;
  std::vector<HexahedronPack> packs_;
  MaxwellBranches maxwell_;
  J2Yield yield_;
  std::vector<Moduli> stiffness_;  // relative, by pack and point; empty: all 1
};

/// Longest stable step, s, of the explicit integration of a solid at rest: nodal masses (kg), an
/// isotropic spring to the environment per node (N/m), fixed nodes. By power iteration; viscosity
/// shortens it because velocities lag by half a step (Belytschko, Liu, Moran: Nonlinear Finite
/// Elements, sec. 6.2). Takes the solid by value because it modifies its history.
double critical_step(const HexahedralGrid& grid, NeoHookeanSolid solid,
                     const Eigen::VectorXd& masses, const Eigen::VectorXd& springs,
                     const std::vector<int>& held);

}  // namespace palpate::object
