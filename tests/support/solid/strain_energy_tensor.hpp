#pragma once

#include <Eigen/Core>

#include "core/solid/strain_energy.hpp"

namespace palpate::support {

/// Response of a material to a deformation gradient F, for finite elements. Tensors are columns of
/// 9, the matrix columns in succession (P(i, j) at i + 3 j).
struct TensorStress {
  double energy = 0;                    // J/m^3 of rest volume
  Eigen::Matrix3d stress;               // first Piola-Kirchhoff P = dPsi/dF, Pa
  Eigen::Matrix<double, 9, 9> tangent;  // dP/dF, symmetric
  /// Derivative of P with respect to the constants.
  Eigen::Matrix<double, 9, Eigen::Dynamic> by_constant;
};

/// By the singular values of F (Stomakhin et al. 2012, section 4; Bonet and Wood 2008, section
/// 6.6). nu < 0.5. False if det F is not positive, for which these materials are undefined.
bool respond_to_gradient(const solid::StrainEnergy& material, const Eigen::VectorXd& constants,
                         const Eigen::Matrix3d& F, TensorStress& result);

}  // namespace palpate::support
