#pragma once

#include <Eigen/Core>

namespace palpate::solid {

/// Isotropic hyperelastic solid for large strain, energy per rest volume, Pa,
///   W = c10 (I1 - 3) + c01 (I2 - 3) + c20 (I1 - 3)^2 + bulk_point/2 (J - 1)^2
///       + bulk_mean/2 (J_mean - 1)^2,
/// where I1, I2 are the invariants of J^(-2/3) F^T F and J_mean is the mean of J = det F over an
/// element. W is linear in its constants, so that the same routines compute derivatives with
/// respect to them.
struct SolidCoefficients {
  double c10 = 0, c01 = 0, c20 = 0;      // Pa
  double bulk_point = 0, bulk_mean = 0;  // Pa; their sum is the bulk modulus

  bool is_zero() const {
    return c10 == 0 && c01 == 0 && c20 == 0 && bulk_point == 0 && bulk_mean == 0;
  }
  SolidCoefficients operator*(double factor) const {
    return {factor * c10, factor * c01, factor * c20, factor * bulk_point, factor * bulk_mean};
  }
};

/// Constants and their derivatives with respect to Young's modulus and Poisson's ratio.
struct SolidMaterial {
  SolidCoefficients coefficients;
  SolidCoefficients by_young;    // per Pa
  SolidCoefficients by_poisson;  // per unit
};

/// From Young's modulus (Pa, > 0) and Poisson's ratio (0 <= nu < 0.5) at small strain. Neo-Hookean
/// for `mooney` = 0; otherwise this fraction of the shear modulus goes to c01 (Mooney-Rivlin).
/// `stiffening` is c20 divided by the shear modulus (Yeoh's second constant). Throws
/// std::invalid_argument.
///
/// A ten-node tetrahedron cannot conserve the volume at each of its four points without locking;
/// conserving only its mean leaves conformal motions of an element without stiffness. The points
/// therefore carry the part of the bulk modulus K that does not lock, bulk_point = K c mu / (K + c
/// mu) with c = kPointBulk, and the mean carries the rest.
SolidMaterial make_solid_material(double young_modulus, double poisson_ratio, double mooney = 0,
                                  double stiffening = 0);
inline constexpr double kPointBulk = 1;

/// First Piola-Kirchhoff stress at a point and its derivative, both with respect to F column by
/// column.
struct PointResponse {
  double energy = 0;                    // Pa
  Eigen::Matrix3d stress;               // Pa
  Eigen::Matrix<double, 9, 9> tangent;  // Pa
};

/// All terms except that of J_mean. False if det F is not positive; then nothing is written.
bool point_response(const Eigen::Matrix3d& F, const SolidCoefficients& c, bool with_tangent,
                    PointResponse& response);

/// J = det F with its first derivative (the cofactors) and its second, both column by column.
double volume_ratio(const Eigen::Matrix3d& F, Eigen::Matrix3d& cofactors,
                    Eigen::Matrix<double, 9, 9>* second = nullptr);

}  // namespace palpate::solid
