#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate::math {

/// The rotation R nearest to F, the one that makes tr(R^T F) largest: that of the polar
/// decomposition F = R S where det F > 0; always proper, also where F is inverted or singular
/// (there the smallest stretch is negative or the choice is arbitrary). Identity where F is not
/// finite.
///
/// `warm` is where the search starts, for instance the answer of the last step, and becomes the
/// answer: some 2 Newton steps when F has turned little (analytic polar decomposition, Kugelstadt,
/// Koschier and Bender 2018), a singular value decomposition where Newton's method is not safe.
Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& F, Eigen::Quaterniond& warm) noexcept;

/// Same, with a cold start.
Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& F) noexcept;

/// Derivative of R = polar_rotation(F): with A = polar_spin(R, F), dR = R [w]x where
/// w = A vee(R^T dF - dF^T R), A = (tr(S) I - S)^-1, S = R^T F. Where two stretches cancel (an
/// inverted element about to flip) R jumps; there A is bounded by 1e6 divided by the size of S.
Eigen::Matrix3d polar_spin(const Eigen::Matrix3d& R, const Eigen::Matrix3d& F) noexcept;

}  // namespace palpate::math
