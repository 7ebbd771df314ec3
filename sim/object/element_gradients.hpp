#pragma once

#include <Eigen/Core>
#include <array>

#include "core/math/pack.hpp"

namespace palpate::object {

using math::Pack4d;

inline constexpr int kGaussPoints = 27;  // of an element: 3 x 3 x 3, x fastest
inline constexpr int kTogether =
    math::kLanes<Pack4d>;  // elements processed in parallel (SIMD lanes)

/// A 3 x 3 tensor of each of several elements, one per lane, row by row.
using PackTensor = std::array<Pack4d, 9>;

/// The same at every Gauss point.
using ElementGradients = std::array<PackTensor, kGaussPoints>;

/// The tensor at one point of one of the elements.
inline Eigen::Matrix3d tensor_at(const ElementGradients& field, int lane, int point) noexcept {
  Eigen::Matrix3d tensor;
  for (int k = 0; k < 9; ++k) tensor(k / 3, k % 3) = field[point][k][lane];
  return tensor;
}

/// Writes the tensor at one point of one of the elements.
inline void set_tensor(ElementGradients& field, int lane, int point,
                       const Eigen::Matrix3d& tensor) noexcept {
  for (int k = 0; k < 9; ++k) field[point][k][lane] = tensor(k / 3, k % 3);
}

}  // namespace palpate::object
