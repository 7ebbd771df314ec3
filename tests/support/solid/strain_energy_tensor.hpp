#pragma once

#include <Eigen/Core>

#include "core/solid/strain_energy.hpp"

namespace palpate::support {

/// A material's answer to a deformation gradient F, for finite elements. Tensors are columns of 9,
/// the matrix' columns behind each other (P(i, j) at i + 3 j).
struct TensorStress {
  double energy = 0;                                     // J per rest volume
  Eigen::Matrix3d stress;                                // first Piola-Kirchhoff P = dPsi/dF, Pa
  Eigen::Matrix<double, 9, 9> tangent;                   // dP/dF, symmetric
  Eigen::Matrix<double, 9, Eigen::Dynamic> by_constant;  // dP by the constants
};

/// Through the singular values of F (Stomakhin et al. 2012, section 4; Bonet and Wood 2008,
/// section 6.6). nu below 0.5. False where det F is not positive: these materials know no inverted
/// element.
bool respond_to_gradient(const solid::StrainEnergy& material, const Eigen::VectorXd& constants,
                         const Eigen::Matrix3d& F, TensorStress& result);

}  // namespace palpate::support
