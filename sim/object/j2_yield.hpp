#pragma once

#include <Eigen/Core>

#include "sim/object/element_gradients.hpp"
#include "sim/object/neo_hookean.hpp"

namespace palpate::object {

/// Yield parameters of an object.
struct Yield {
  double stress = 0;     // von Mises (Kirchhoff) stress at first yield, Pa
  double hardening = 0;  // Pa, increase of that stress per plastic strain
};

/// Finite-strain plasticity at every Gauss point: F = F_e F_p with a Neo-Hookean F_e, von Mises
/// yield |dev tau| <= sqrt(2/3) (sigma_y + H alpha), isotropic hardening, isochoric plastic flow,
/// as of dough and clay; the crushing of a foam, which loses volume, is not modelled.
///
/// The return mapping is that of Weber and Anand (Comp. Meth. Appl. Mech. Eng. 79 (1990) 173) and
/// Eterovic and Bathe (IJNME 30 (1990) 1099): an exponential map along the deviator of the
/// logarithmic elastic strain in its principal axes. dev tau has the same ordering as that
/// deviator, so that flow always dissipates, and rotations have no effect.
class J2Yield {
 public:
  J2Yield() = default;

  /// Throws std::invalid_argument unless stress > 0 and hardening >= 0.
  J2Yield(const NeoHookean& material, const Yield& yield, int elements);

  bool empty() const { return inverse_.cols() == 0; }

  /// Turns the deformation gradients of an element, which occupies that lane of F, into their
  /// elastic parts, with plastic flow where the stress exceeds yield. Points below a fifth of their
  /// volume or inverted do not flow, nor does a point beyond a plastic stretch of about three: its
  /// element would be unusable. Returns a bound, at least 1, on the stiffening of the nodes by
  /// plastic strain.
  double flow(int element, int lane, ElementGradients& F) noexcept;

  /// Turns deformation gradients into their elastic parts at the current plastic state.
  void take_out(int element, int lane, ElementGradients& F) const noexcept;

  /// Converts the stress conjugate to the elastic part into the one conjugate to F: P F_p^-T.
  void pull_back(int element, int lane, ElementGradients& P) const noexcept;

  /// Accumulated equivalent plastic strain, maximum over all points.
  double greatest_strain() const { return empty() ? 0 : strain_.maxCoeff(); }

 private:
  Eigen::Matrix3d plastic_inverse(int element, int point) const noexcept;
  double flow_length(const Eigen::Vector3d& log_stretch, const Eigen::Vector3d& direction,
                     double bound, double strain) const noexcept;

  NeoHookean material_;
  Yield yield_;
  Eigen::Matrix<double, 9, Eigen::Dynamic> inverse_;  // F_p^-1, column-major, by point
  Eigen::VectorXd strain_;                            // alpha
  Eigen::VectorXd stiffening_;                        // reported by flow(), by point
};

}  // namespace palpate::object
