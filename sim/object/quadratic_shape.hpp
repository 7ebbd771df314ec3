#pragma once

#include <array>

namespace palpate::object {

/// Quadratic Lagrange polynomials with nodes -1, 0, 1 and their slopes at `xi`.
struct QuadraticShape {
  explicit QuadraticShape(double xi)
      : value{0.5 * xi * (xi - 1), 1 - xi * xi, 0.5 * xi * (xi + 1)},
        slope{xi - 0.5, -2 * xi, xi + 0.5} {}

  std::array<double, 3> value;
  std::array<double, 3> slope;
};

/// Share of a length associated with each of the three nodes (Gauss-Lobatto, i.e. Simpson).
inline constexpr std::array<double, 3> kLobattoShare{1.0 / 6, 4.0 / 6, 1.0 / 6};

}  // namespace palpate::object
