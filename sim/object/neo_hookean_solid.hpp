#pragma once

#include <Eigen/Core>

#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

/// Elastic constants of the plant.
struct NeoHookean {
  double shear_modulus = 0;  // mu, Pa
  double lame = 0;           // lambda, Pa

  /// Throws std::invalid_argument unless E > 0 and 0 <= nu < 0.5.
  static NeoHookean from_young(double young_modulus, double poisson_ratio);
};

/// Stored energy and nodal forces of a compressible Neo-Hookean solid on a hexahedral grid.
///
/// Energy per rest volume (Bonet and Wood, Nonlinear Continuum Mechanics, 2nd ed., eq. 6.27):
///   Psi = mu/2 (tr F'F - 3) - mu l + lambda/2 l^2,  P = mu F + (lambda l - mu) l' cof F,
/// with l = log J. Below J = kLeastVolumeRatio the logarithm is continued by its tangent, so that
/// energy and force stay finite, consistent with each other and restoring for any F, inverted ones
/// too. 3 x 3 x 3 Gauss points; all elements are equal boxes, so one set of gradients serves all.
///
/// Optional viscosity: second Piola-Kirchhoff stress eta dC/dt, zero in any rigid motion.
class NeoHookeanSolid {
 public:
  /// Volume ratio below which log J is continued linearly.
  static constexpr double kLeastVolumeRatio = 0.2;

  /// viscosity: eta, Pa s.
  NeoHookeanSolid(const HexahedralGrid& grid, const NeoHookean& material, double viscosity);

  /// Adds to `forces` (3 x node count, N) minus the derivative of the energy by `positions`, and
  /// the viscous forces where there is a viscosity. Returns how much stiffer than at rest the most
  /// compressed point is: an estimate, at least 1, of the growth of the greatest eigenvalue of the
  /// tangent stiffness.
  double add_forces(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities,
                    Eigen::Matrix3Xd& forces) const noexcept;

  /// Stored energy, J.
  double energy(const Eigen::Matrix3Xd& positions) const noexcept;

  double viscosity() const { return viscosity_; }

 private:
  // Gauss points are padded to a multiple of four with a copy of the first one of weight zero, and
  // so are nodes, so that every loop over them fills whole vector registers.
  static constexpr int kPoints = 28;
  static constexpr int kNodes = 28;
  static constexpr int kGradients = 3 * kPoints;  // row: axis * kPoints + point

  using Corners = Eigen::Matrix<double, kNodes, 3>;
  using Gradients = Eigen::Matrix<double, kGradients, 3>;  // column i, row (j, point): A_ij(point)

  Corners gather(const Eigen::Matrix3Xd& values, int element) const noexcept;
  double first_piola(const Gradients& F, Gradients& P) const noexcept;
  void add_viscous_stress(const Gradients& F, const Gradients& F_rate, Gradients& P) const noexcept;

  NeoHookean material_;
  double viscosity_;
  Eigen::MatrixXi elements_;
  Eigen::Matrix<double, kGradients, 27> gradients_;       // d shape / d rest coordinate
  Eigen::Matrix<double, kNodes, kGradients> divergence_;  // its transpose times minus the weight
  Eigen::Array<double, kPoints, 1> weights_;              // Gauss weight times rest volume, m^3
};

}  // namespace palpate::object
