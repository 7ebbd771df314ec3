#pragma once

#include <array>

namespace palpate::solid {

/// Quadratic shape functions of a line at s in [-1, 1], of its ends and midpoint in order, and
/// their derivatives with respect to s. Products of two are those of a nine-node quadrilateral.
inline std::array<double, 3> line_shape(double s) {
  return {s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2};
}
inline std::array<double, 3> line_slope(double s) { return {s - 0.5, -2 * s, s + 0.5}; }

/// The three Gauss points of a line and their weights.
inline constexpr std::array<double, 3> kGaussPoints = {-0.77459666924148338, 0,
                                                       0.77459666924148338};
inline constexpr std::array<double, 3> kGaussWeights = {5. / 9, 8. / 9, 5. / 9};

}  // namespace palpate::solid
