#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "sim/object/element_gradients.hpp"

namespace palpate::object {

/// Equal 27-node boxes side by side, one a lane: from nodal values to gradients at the Gauss points
/// and back. Both go line by line along one axis after the other (sum factorisation: Orszag, J.
/// Comput. Phys. 37 (1980) 70): values at the nodes, values at the points, slopes there.
class HexahedronPack {
 public:
  /// One vector at each node or point of each element, by axis.
  using Vectors = std::array<std::array<Pack4d, 27>, 3>;

  static constexpr double kGauss = 0.77459666924148337704;  // sqrt(0.6): points on [-1, 1]

  /// Where a Gauss point divides the sides of its element, and its share of the volume.
  static Eigen::Array3d point(int index) {
    return 0.5 + 0.5 * kGauss * (Eigen::Array3d(index % 3, index / 3 % 3, index / 9) - 1);
  }
  static double weight(int index) {
    constexpr std::array<double, 3> kShare{5. / 18, 8. / 18, 5. / 18};
    return kShare[index % 3] * kShare[index / 3 % 3] * kShare[index / 9];
  }

  /// Numbers in nodal fields; where `elements` has fewer columns than lanes are left, lanes repeat
  /// its last one and are not in use.
  HexahedronPack(const Eigen::MatrixXi& elements, int first) {
    const int count = static_cast<int>(elements.cols());
    lanes_ = std::min(kTogether, count - first);
    for (int a = 0; a < 27; ++a) {
      for (int lane = 0; lane < kTogether; ++lane)
        offsets_[a][lane] = 3 * elements(a, std::min(first + lane, count - 1));
    }
  }

  int lanes() const { return lanes_; }  // in use

  /// `field` is 3 x node count.
  void gather(const double* field, Vectors& values) const noexcept {
    for (int a = 0; a < 27; ++a) {
      const auto& at = offsets_[a];
      const Pack4d p = vector(field + at[0]), q = vector(field + at[1]);
      const Pack4d r = vector(field + at[2]), s = vector(field + at[3]);
      const Pack4d xz_p = __builtin_shufflevector(p, q, 0, 4, 2, 6);
      const Pack4d xz_r = __builtin_shufflevector(r, s, 0, 4, 2, 6);
      const Pack4d y_p = __builtin_shufflevector(p, q, 1, 5, 1, 5);
      const Pack4d y_r = __builtin_shufflevector(r, s, 1, 5, 1, 5);
      values[0][a] = __builtin_shufflevector(xz_p, xz_r, 0, 1, 4, 5);
      values[1][a] = __builtin_shufflevector(y_p, y_r, 0, 1, 4, 5);
      values[2][a] = __builtin_shufflevector(xz_p, xz_r, 2, 3, 6, 7);
    }
  }

  /// Adds to a field, lane after lane, as elements share nodes.
  void scatter(const Vectors& values, double* field) const noexcept {
    for (int a = 0; a < 27; ++a) {
      const Pack4d x = values[0][a], y = values[1][a], z = values[2][a];
      const Pack4d xy_even = __builtin_shufflevector(x, y, 0, 4, 2, 6);
      const Pack4d xy_odd = __builtin_shufflevector(x, y, 1, 5, 3, 7);
      const Pack4d columns[] = {__builtin_shufflevector(xy_even, z, 0, 1, 4, 4),
                                __builtin_shufflevector(xy_odd, z, 0, 1, 5, 5),
                                __builtin_shufflevector(xy_even, z, 2, 3, 6, 6),
                                __builtin_shufflevector(xy_odd, z, 2, 3, 7, 7)};
      for (int lane = 0; lane < lanes_; ++lane) {
        double* to = field + offsets_[a][lane];
        for (int c = 0; c < 3; ++c) to[c] += columns[lane][c];
      }
    }
  }

  /// Gradients by the rest coordinates of nodal values, which are overwritten by those at the Gauss
  /// points. `slopes`: 1 / (kGauss h) for element sides h.
  static void gradients(Vectors& values, const std::array<double, 3>& slopes,
                        ElementGradients& out) noexcept {
    for (int i = 0; i < 3; ++i) {
      auto& v = values[i];
      for (int axis = 0; axis < 3; ++axis) {
        for_each_line(axis, [&v](int p0, int p1, int p2) { to_points(v[p0], v[p1], v[p2]); });
      }
      for (int axis = 0; axis < 3; ++axis) {
        const double slope = slopes[axis];
        for_each_line(axis, [&](int p0, int p1, int p2) {
          const Pack4d middle = slope * (v[p2] - v[p0]);
          const Pack4d change = 2 * slope * (v[p0] + v[p2] - 2 * v[p1]);
          out[p0][3 * i + axis] = middle - change;
          out[p1][3 * i + axis] = middle;
          out[p2][3 * i + axis] = middle + change;
        });
      }
    }
  }

  /// The transpose of gradients() after weighting the points by those of Gauss on [0, 1], 5/18,
  /// 8/18, 5/18 along each axis.
  static void divergence(const ElementGradients& field, const std::array<double, 3>& slopes,
                         Vectors& values) noexcept {
    for (int i = 0; i < 3; ++i) {
      auto& v = values[i];
      v.fill(Pack4d{});
      for (int axis = 0; axis < 3; ++axis) {
        // Weights along the axis, over that of the receiving point, which to_nodes() brings in.
        const double slope = slopes[axis];
        for_each_line(axis, [&](int p0, int p1, int p2) {
          const Pack4d a = field[p0][3 * i + axis], b = field[p2][3 * i + axis];
          const Pack4d sum = slope * (a + 8. / 5 * field[p1][3 * i + axis] + b);
          const Pack4d difference = 2 * slope * (b - a);
          v[p0] += difference - sum;
          v[p1] -= 2 * 5. / 8 * difference;
          v[p2] += difference + sum;
        });
      }
      for (int axis = 0; axis < 3; ++axis) {
        for_each_line(axis, [&v](int p0, int p1, int p2) { to_nodes(v[p0], v[p1], v[p2]); });
      }
    }
  }

 private:
  static Pack4d vector(const double* p) noexcept { return Pack4d{p[0], p[1], p[2], 0}; }

  /// Calls visit(p0, p1, p2) for the nine lines of three nodes or points along an axis.
  template <class Visit>
  static void for_each_line(int axis, const Visit& visit) noexcept {
    const int along = axis == 0 ? 1 : axis == 1 ? 3 : 9;
    const int u = axis == 0 ? 3 : 1, v = axis == 2 ? 3 : 9;
    for (int n = 0; n < 3; ++n) {
      for (int m = 0; m < 3; ++m) {
        const int first = m * u + n * v;
        visit(first, first + along, first + 2 * along);
      }
    }
  }

  /// The quadratic through values at -1, 0 and 1, at -kGauss, 0 and kGauss.
  static void to_points(Pack4d& a, const Pack4d& b, Pack4d& c) noexcept {
    const Pack4d middle = 0.4 * b + 0.3 * (a + c), odd = 0.5 * kGauss * (c - a);
    a = middle - odd;
    c = middle + odd;
  }
  /// Its transpose after weighting.
  static void to_nodes(Pack4d& a, Pack4d& b, Pack4d& c) noexcept {
    const Pack4d even = a + c, odd = 5. / 18 * 0.5 * kGauss * (c - a);
    a = 5. / 18 * 0.3 * even - odd;
    b = 8. / 18 * b + 5. / 18 * 0.4 * even;
    c = 5. / 18 * 0.3 * even + odd;
  }

  std::array<std::array<int, kTogether>, 27> offsets_{};
  int lanes_ = 0;
};

}  // namespace palpate::object
