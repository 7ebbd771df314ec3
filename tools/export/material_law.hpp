#pragma once

#include <Eigen/Core>

namespace palpate::exporting {

/// Constitutive law: that of palpated's model, or that of the simulator's object.
enum class Law { kCorotational, kNeoHookean };

/// Stiffness of an object: from ESTIMATE, or given by the user.
struct Stiffness {
  double young_modulus = 0;  // Pa
  double poisson_ratio = 0;
};

/// Cauchy stress, Pa, at the deformation gradient F, with E = R^T F - 1 and J = det F:
///    co-rotational  R (2 mu E + lambda tr(E) 1) (1 + E) R^T / J
///    Neo-Hookean    (mu (F F^T - 1) + lambda log(J) 1) / J
/// J is limited from below to kSmallestVolumeShare.
inline constexpr double kSmallestVolumeShare = 0.01;
Eigen::Matrix3d cauchy_stress(Law law, const Eigen::Matrix3d& F, const Stiffness& stiffness);

/// First Piola-Kirchhoff stress of the co-rotational law, Pa: R (2 mu E + lambda tr(E) 1).
Eigen::Matrix3d corotational_first_stress(const Eigen::Matrix3d& F, const Stiffness& stiffness);

}  // namespace palpate::exporting
