#pragma once

#include "core/elasticity/static_solver.hpp"

namespace palpate::fit {

/// Small vibrations of an object about an equilibrium, with the hand (grasp 0) standing still: the
/// lowest modes of K phi = omega^2 M phi over the free nodes, of unit modal mass, K the exact
/// tangent of the daemon's elements and M their consistent mass. Rayleigh damping keeps them
/// decoupled: q'' + (mass_factor + stiffness_factor omega^2) q' + omega^2 q = 0.
struct HeldModes {
  Eigen::VectorXd frequencies;  // omega, rad/s, ascending
  /// Wrench on the object by the hand at the origin of G, in O, per q + stiffness_factor q': N and
  /// N m by sqrt(kg) m. One column per mode.
  Eigen::Matrix<double, 6, Eigen::Dynamic> wrenches;
  /// q' just after the hand, with a twist in O of the origin of G, has stopped instantly, per that
  /// twist; until then the object has followed in equilibrium. One row per mode.
  Eigen::Matrix<double, Eigen::Dynamic, 6> stops;
};

/// The `count` lowest modes at the equilibrium `at` under the hand's pose X_OG, by subspace
/// iteration. Throws std::invalid_argument if the equilibrium is not stable.
HeldModes find_modes(const elasticity::Body& body, const math::Pose& X_OG,
                     const Eigen::Matrix3Xd& at, int count);

}  // namespace palpate::fit
