#pragma once

#include "core/math/rigid.hpp"

namespace palpate::support {

/// dR of R = polar_rotation(F) for a change dF of F; A = polar_spin(R, F).
inline Eigen::Matrix3d polar_rotation_derivative(const Eigen::Matrix3d& R, const Eigen::Matrix3d& A,
                                                 const Eigen::Matrix3d& dF) {
  const Eigen::Matrix3d B = R.transpose() * dF;
  const Eigen::Vector3d turn(B(2, 1) - B(1, 2), B(0, 2) - B(2, 0), B(1, 0) - B(0, 1));
  return R * math::cross_matrix(A * turn);
}

}  // namespace palpate::support
