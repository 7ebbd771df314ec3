#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "core/math/pack.hpp"
#include "sim/object/element_gradients.hpp"
#include "sim/object/hexahedral_grid.hpp"

namespace palpate::object {

/// Logarithm and reciprocal of positive normal numbers, sharing one division.
struct LogAndInverse {
  math::Pack4d log, inverse;
};

/// Per lane, accurate to about two units in the last place of the result: x = 2^k m with m in
/// [sqrt(1/2), sqrt(2)), log m = 2 artanh(s), s = (m - 1) / (m + 1).
inline LogAndInverse log_and_inverse(math::Pack4d x) noexcept {
  using Bits = std::uint64_t __attribute__((vector_size(32)));
  constexpr std::uint64_t kOne = 0x3ff0000000000000;       // bits of 1
  constexpr std::uint64_t kRootHalf = 0x3fe6a09e00000000;  // of sqrt(1/2), nearly
  constexpr std::uint64_t kMantissa = 0x000fffffffffffff;
  constexpr std::uint64_t kTwo52 = 0x4330000000000000;  // of 2^52: adding n to them adds n to it
  constexpr double kLog2High = 0x1.62e42feep-1;         // log 2 in two parts: k times the first one
  constexpr double kLog2Low = 0x1.a39ef35793c76p-33;    // is exact

  Bits bits;
  std::memcpy(&bits, &x, sizeof(bits));
  bits += kOne - kRootHalf;
  const Bits biased = (bits >> 52) + kTwo52;
  const Bits reduced = (bits & kMantissa) + kRootHalf;
  math::Pack4d k, m;
  std::memcpy(&k, &biased, sizeof(k));
  std::memcpy(&m, &reduced, sizeof(m));
  k -= 0x1p52 + 1023;

  // log(1 + f) = f - f^2/2 + s (f^2/2 + r) with r = 2 (artanh(s) / s - 1); s^2 < 0.0295.
  const math::Pack4d f = m - 1;
  const math::Pack4d both = 1 / (x * (2 + f));
  const math::Pack4d s = f * (both * x);
  const math::Pack4d z = s * s, z2 = z * z, z4 = z2 * z2;
  const math::Pack4d low = (2. / 3 + 2. / 5 * z) + (2. / 7 + 2. / 9 * z) * z2;
  const math::Pack4d high = (2. / 11 + 2. / 13 * z) + (2. / 15 + 2. / 17 * z) * z2;
  const math::Pack4d r = z * (low + (high + (2. / 19 + 2. / 21 * z) * z4) * z4);
  const math::Pack4d half_square = 0.5 * f * f;
  const math::Pack4d log_m = f - (half_square - (s * (half_square + r) + k * kLog2Low));
  return {k * kLog2High + log_m, both * (2 + f)};
}

/// 27-node boxes, one per SIMD lane: nodal values to gradients at the Gauss points and back. Both
/// are evaluated line by line along one axis after the other (sum factorisation: Orszag, J. Comput.
/// Phys. 37 (1980) 70): values at the nodes, values at the points, slopes there.
class HexahedronPack {
 public:
  /// One vector at each node or point of each element, by axis.
  using Vectors = std::array<std::array<Pack4d, 27>, 3>;

  static constexpr double kGauss = 0.77459666924148337704;  // sqrt(0.6): points on [-1, 1]

  /// Position of a Gauss point along the sides of its element, and its share of the volume.
  static Eigen::Array3d point(int index) {
    const int x = index % 3, y = index / 3 % 3, z = index / 9;
    return 0.5 + 0.5 * kGauss * (Eigen::Array3d(x, y, z) - 1);
  }
  static double weight(int index) {
    constexpr std::array<double, 3> kShare{5. / 18, 8. / 18, 5. / 18};
    return kShare[index % 3] * kShare[index / 3 % 3] * kShare[index / 9];
  }

  /// Elements of the grid from `first` on; if fewer remain than there are lanes, surplus lanes
  /// repeat the last element and are unused.
  HexahedronPack(const HexahedralGrid& grid, int first)
      : lanes_(std::min(kTogether, grid.element_count() - first)) {
    for (int lane = 0; lane < kTogether; ++lane) {
      const int element = std::min(first + lane, grid.element_count() - 1);
      const Eigen::Vector3d size = grid.element_size(element);
      volume_[lane] = size.prod();
      for (int axis = 0; axis < 3; ++axis) slopes_[axis][lane] = 1 / (kGauss * size[axis]);
      for (int a = 0; a < 27; ++a) offsets_[a][lane] = 3 * grid.elements()(a, element);
    }
  }

  int lanes() const { return lanes_; }                              // in use
  double volume(int lane) const noexcept { return volume_[lane]; }  // at rest, m^3

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

  /// Adds to a field lane by lane, as elements share nodes.
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

  /// Gradients with respect to the rest coordinates of nodal values, which are overwritten by the
  /// values at the Gauss points.
  void gradients(Vectors& values, ElementGradients& out) const noexcept {
    const std::array<Pack4d, 3> slopes = slopes_;
    for (int i = 0; i < 3; ++i) {
      Pack4d* v = values[i].data();
      interpolate<0>(v);
      interpolate<1>(v);
      interpolate<2>(v);
      Pack4d* to = out[0].data() + 3 * i;
      differentiate<0>(v, slopes[0], to);
      differentiate<1>(v, slopes[1], to + 1);
      differentiate<2>(v, slopes[2], to + 2);
    }
  }

  /// Minus the transpose of gradients() after weighting the points by their volumes: nodal forces
  /// of a stress.
  void divergence(const ElementGradients& field, Vectors& values) const noexcept {
    const std::array<Pack4d, 3> slopes{-volume_ * slopes_[0], -volume_ * slopes_[1],
                                       -volume_ * slopes_[2]};
    for (int i = 0; i < 3; ++i) {
      Pack4d* v = values[i].data();
      const Pack4d* from = field[0].data() + 3 * i;
      for_each_line<2>([&](int p0, int p1, int p2) {
        const Flux flux(from + 2, slopes[2], p0, p1, p2);
        v[p0] = flux.a;
        v[p1] = flux.b;
        v[p2] = flux.c;
      });
      for (int plane = 0; plane < 27; plane += 9, from += 81) {
        Plane w;
        for (int n = 0; n < 9; ++n) w[n] = v[plane + n];
        const auto add = [&w](int p0, int p1, int p2, const Flux& flux) {
          w[p0] += flux.a;
          w[p1] += flux.b;
          w[p2] += flux.c;
        };
        for_each_line_in_plane<0>(
            [&](int p0, int p1, int p2) { add(p0, p1, p2, Flux(from, slopes[0], p0, p1, p2)); });
        for_each_line_in_plane<1>([&](int p0, int p1, int p2) {
          add(p0, p1, p2, Flux(from + 1, slopes[1], p0, p1, p2));
        });
        const auto share = [&w](int p0, int p1, int p2) { distribute(w[p0], w[p1], w[p2]); };
        for_each_line_in_plane<0>(share);
        for_each_line_in_plane<1>(share);
        for (int n = 0; n < 9; ++n) v[plane + n] = w[n];
      }
      for_each_line<2>([&](int p0, int p1, int p2) { distribute(v[p0], v[p1], v[p2]); });
    }
  }

 private:
  /// Values across the third axis: few enough for registers.
  using Plane = std::array<Pack4d, 9>;

  static Pack4d vector(const double* p) noexcept { return Pack4d{p[0], p[1], p[2], 0}; }

  /// Calls visit(p0, p1, p2) for the nine lines of three nodes or points along an axis.
  template <int kAxis, class Visit>
  [[gnu::always_inline]] static void for_each_line(const Visit& visit) noexcept {
    constexpr int kAlong = kAxis == 0 ? 1 : kAxis == 1 ? 3 : 9;
    constexpr int kU = kAxis == 0 ? 3 : 1, kV = kAxis == 2 ? 3 : 9;
#pragma GCC unroll 9
    for (int line = 0; line < 9; ++line) {
      const int first = line % 3 * kU + line / 3 * kV;
      visit(first, first + kAlong, first + 2 * kAlong);
    }
  }

  /// The same for the three lines in a plane across the third axis.
  template <int kAxis, class Visit>
  [[gnu::always_inline]] static void for_each_line_in_plane(const Visit& visit) noexcept {
    constexpr int kAlong = kAxis == 0 ? 1 : 3, kApart = kAxis == 0 ? 3 : 1;
    visit(0, kAlong, 2 * kAlong);
    visit(kApart, kApart + kAlong, kApart + 2 * kAlong);
    visit(2 * kApart, 2 * kApart + kAlong, 2 * kApart + 2 * kAlong);
  }

  /// From values at -1, 0 and 1 to those of the quadratic through them at -kGauss, 0 and kGauss.
  template <int kAxis>
  static void interpolate(Pack4d* v) noexcept {
    for_each_line<kAxis>([v](int p0, int p1, int p2) {
      const Pack4d a = v[p0], c = v[p2];
      const Pack4d middle = 0.4 * v[p1] + 0.3 * (a + c), odd = 0.5 * kGauss * (c - a);
      v[p0] = middle - odd;
      v[p2] = middle + odd;
    });
  }

  /// Its transpose after weighting.
  static void distribute(Pack4d& a, Pack4d& b, Pack4d& c) noexcept {
    const Pack4d even = a + c, odd = 5. / 18 * 0.5 * kGauss * (c - a);
    a = 5. / 18 * 0.3 * even - odd;
    b = 8. / 18 * b + 5. / 18 * 0.4 * even;
    c = 5. / 18 * 0.3 * even + odd;
  }

  /// Slopes of the quadratic at the points from its values there; those of a point lie 9 apart.
  template <int kAxis>
  static void differentiate(const Pack4d* v, Pack4d slope, Pack4d* out) noexcept {
    for_each_line<kAxis>([=](int p0, int p1, int p2) {
      const Pack4d middle = slope * (v[p2] - v[p0]);
      const Pack4d change = 2 * slope * (v[p0] + v[p2] - 2 * v[p1]);
      out[9 * p0] = middle - change;
      out[9 * p1] = middle;
      out[9 * p2] = middle + change;
    });
  }

  /// The transpose of differentiate() on one line, weighted along the axis and divided by the
  /// weight of the receiving point, which distribute() applies.
  struct Flux {
    Flux(const Pack4d* field, Pack4d slope, int p0, int p1, int p2) noexcept {
      const Pack4d first = field[9 * p0], last = field[9 * p2];
      const Pack4d sum = slope * (first + 8. / 5 * field[9 * p1] + last);
      const Pack4d difference = 2 * slope * (last - first);
      a = difference - sum;
      b = -2 * 5. / 8 * difference;
      c = difference + sum;
    }
    Pack4d a, b, c;
  };

  std::array<std::array<int, kTogether>, 27> offsets_{};
  std::array<Pack4d, 3> slopes_{};  // 1 / (kGauss h) for element sides h
  Pack4d volume_{};
  int lanes_ = 0;
};

}  // namespace palpate::object
