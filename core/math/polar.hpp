#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace palpate::math {

/// Rotation R nearest to F, i.e. the maximiser of tr(R^T F): the rotation of the polar
/// decomposition F = R S if det F > 0. Always a proper rotation, also if F is inverted or singular
/// (the smallest stretch is then negative, or the choice arbitrary). Identity if F is not finite.
///
/// `warm` is the starting point, for instance the result of the last step, and receives the result.
/// About 2 Newton steps suffice if F has rotated little (analytic polar decomposition, Kugelstadt,
/// Koschier and Bender 2018); a singular value decomposition is used where Newton's method is not
/// safe.
Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& F, Eigen::Quaterniond& warm) noexcept;

/// Same, without a starting point.
Eigen::Matrix3d polar_rotation(const Eigen::Matrix3d& F) noexcept;

/// Derivative of R = polar_rotation(F): dR = R [w]x with w = A vee(R^T dF - dF^T R), A = (tr(S) I -
/// S)^-1, S = R^T F; returns A. Where two stretches cancel (an inverted element about to flip) R is
/// discontinuous; there A is bounded by 1e6 divided by the norm of S.
Eigen::Matrix3d polar_spin(const Eigen::Matrix3d& R, const Eigen::Matrix3d& F) noexcept;

}  // namespace palpate::math
