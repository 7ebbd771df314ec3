#pragma once

#include <Eigen/Core>

#include "sim/object/element_gradients.hpp"
#include "sim/object/neo_hookean.hpp"

namespace palpate::object {

/// When an object stops coming back.
struct Yield {
  double stress = 0;     // von Mises (Kirchhoff) stress at which it first flows, Pa
  double hardening = 0;  // Pa, growth of that stress with the plastic strain
};

/// Plasticity at finite strain at every Gauss point: F = F_e F_p with a Neo-Hookean F_e, von Mises
/// yield |dev tau| <= sqrt(2/3) (sigma_y + H alpha), isotropic hardening, plastic flow without
/// change of volume, as dough and clay flow; a foam's crushing, which loses volume, is not in it.
///
/// The return is that of Weber and Anand (Comp. Meth. Appl. Mech. Eng. 79 (1990) 173) and Eterovic
/// and Bathe (IJNME 30 (1990) 1099): an exponential map along the deviator of the logarithmic
/// elastic strain in its principal axes. dev tau is ordered as that deviator, so that flow always
/// dissipates, and rotations play no part.
class J2Yield {
 public:
  J2Yield() = default;

  /// Throws std::invalid_argument unless stress > 0 and hardening >= 0.
  J2Yield(const NeoHookean& material, const Yield& yield, int elements);

  bool empty() const { return inverse_.cols() == 0; }

  /// Turns the deformation gradients of an element, which has that lane of F, into their elastic
  /// parts, flowing where the stress is beyond yield. Points below a fifth of their volume or
  /// turned inside out do not flow, nor does a point beyond a plastic stretch of about three: its
  /// element would be of no use. Returns a bound, at least 1, on how much plastic strain has
  /// stiffened the nodes.
  double flow(int element, int lane, ElementGradients& F) noexcept;

  /// Turns deformation gradients into their elastic parts at the plastic state as it is.
  void take_out(int element, int lane, ElementGradients& F) const noexcept;

  /// Turns the stress conjugate to the elastic part into that conjugate to F: P F_p^-T.
  void pull_back(int element, int lane, ElementGradients& P) const noexcept;

  /// Accumulated equivalent plastic strain, greatest of all points.
  double greatest_strain() const { return empty() ? 0 : strain_.maxCoeff(); }

 private:
  Eigen::Matrix3d plastic_inverse(int element, int point) const noexcept;
  double flow_length(const Eigen::Vector3d& log_stretch, const Eigen::Vector3d& direction,
                     double bound, double strain) const noexcept;

  NeoHookean material_;
  Yield yield_;
  Eigen::Matrix<double, 9, Eigen::Dynamic> inverse_;  // F_p^-1, column-major, by point
  Eigen::VectorXd strain_;                            // alpha
  Eigen::VectorXd stiffening_;                        // that flow() tells, by point
};

}  // namespace palpate::object
