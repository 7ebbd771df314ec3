#pragma once

#include <Eigen/Core>

namespace palpate::object {

inline constexpr int kGaussPoints = 27;  // of an element: 3 x 3 x 3

/// Gauss points padded to a multiple of four with a copy of the first one of weight zero, so that
/// every loop over them fills whole vector registers.
inline constexpr int kPaddedPoints = 28;

/// A 3 x 3 tensor per Gauss point of one element: column i, row (j, point) holds A_ij(point).
using ElementGradients = Eigen::Matrix<double, 3 * kPaddedPoints, 3>;

/// The tensor at one point.
inline Eigen::Matrix3d tensor_at(const ElementGradients& field, int point) noexcept {
  Eigen::Matrix3d tensor;
  for (int j = 0; j < 3; ++j) tensor.col(j) = field.row(j * kPaddedPoints + point).transpose();
  return tensor;
}

/// Replaces the tensor at one point.
inline void set_tensor(ElementGradients& field, int point, const Eigen::Matrix3d& tensor) noexcept {
  for (int j = 0; j < 3; ++j) field.row(j * kPaddedPoints + point) = tensor.col(j).transpose();
}

}  // namespace palpate::object
