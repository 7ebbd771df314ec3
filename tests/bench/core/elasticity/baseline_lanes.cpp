#include "tests/bench/core/elasticity/baseline_lanes.hpp"

#include "core/math/polar.hpp"

namespace palpate::bench {
namespace {

LaneMatrix rotation_matrix(const std::array<Lanes, 4>& q) {
  const Lanes w = q[0], x = q[1], y = q[2], z = q[3];
  const Lanes s = 2.0 / (w * w + x * x + y * y + z * z);
  return {{{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
           {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
           {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}}};
}

LaneMatrix product(const LaneMatrix& a, const LaneMatrix& b) {
  LaneMatrix c;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  }
  return c;
}

LaneMatrix transpose(const LaneMatrix& a) {
  return {{{a[0][0], a[1][0], a[2][0]}, {a[0][1], a[1][1], a[2][1]}, {a[0][2], a[1][2], a[2][2]}}};
}

/// With B = R^T F: the axis of B - B^T, and the inverse of tr(S) I - S.
struct Curvature {
  explicit Curvature(const LaneMatrix& B)
      : skew{B[2][1] - B[1][2], B[0][2] - B[2][0], B[1][0] - B[0][1]},
        trace(B[0][0] + B[1][1] + B[2][2]) {
    const Lanes a = trace - B[0][0], b = trace - B[1][1], c = trace - B[2][2];
    const Lanes d = -0.5 * (B[0][1] + B[1][0]), e = -0.5 * (B[0][2] + B[2][0]),
                f = -0.5 * (B[1][2] + B[2][1]);
    const Lanes ca = b * c - f * f, cd = e * f - d * c, ce = d * f - e * b;
    const Lanes determinant = a * ca + d * cd + e * ce;
    const Lanes mean = trace * (2.0 / 3.0);
    const auto positive = (a > 0) & (a * b - d * d > 0) & (determinant > 1e-3 * mean * mean * mean);
    for (int l = 0; l < 4; ++l) is_safe[l] = positive[l] != 0;
    const Lanes s = 1.0 / determinant;
    const Lanes cb = a * c - e * e, cf = d * e - a * f, cc = a * b - d * d;
    inverse = {{{s * ca, s * cd, s * ce}, {s * cd, s * cb, s * cf}, {s * ce, s * cf, s * cc}}};
  }
  LaneVector skew;
  Lanes trace;
  std::array<bool, 4> is_safe;
  LaneMatrix inverse;
};

void newton_step(const LaneMatrix& F, std::array<Lanes, 4>& q) {
  const Curvature at(product(transpose(rotation_matrix(q)), F));
  LaneVector h;
  for (int i = 0; i < 3; ++i) {
    h[i] = 0.5 * (at.inverse[i][0] * at.skew[0] + at.inverse[i][1] * at.skew[1] +
                  at.inverse[i][2] * at.skew[2]);
  }
  const Lanes w = q[0], x = q[1], y = q[2], z = q[3];
  // Shortens what the step lengthened, without a square root.
  const Lanes s =
      2.0 / (1 + (w * w + x * x + y * y + z * z) * (1 + h[0] * h[0] + h[1] * h[1] + h[2] * h[2]));
  q = {s * (w - x * h[0] - y * h[1] - z * h[2]), s * (x + w * h[0] + y * h[2] - z * h[1]),
       s * (y + w * h[1] + z * h[0] - x * h[2]), s * (z + w * h[2] + x * h[1] - y * h[0])};
}

Eigen::Matrix3d lane(const LaneMatrix& m, int l) {
  Eigen::Matrix3d r;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r(i, j) = m[i][j][l];
  }
  return r;
}

void set_lane(LaneMatrix& m, int l, const Eigen::Matrix3d& r) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m[i][j][l] = r(i, j);
  }
}

}  // namespace

LaneResponse respond(const LaneMatrix& F, Lanes mu, Lanes lambda, std::array<Lanes, 4>& rotation) {
  const std::array<Lanes, 4> before = rotation;
  // From one tick to the next, two iterations reduce a rotation of 0.05 rad below 1e-10.
  newton_step(F, rotation);
  newton_step(F, rotation);
  LaneResponse r;
  r.rotation = rotation_matrix(rotation);
  Curvature at(product(transpose(r.rotation), F));
  Lanes stretch = at.trace - 3;
  for (int l = 0; l < 4; ++l) {
    double skew = 0;
    for (int i = 0; i < 3; ++i) skew += at.skew[i][l] * at.skew[i][l];
    if (at.is_safe[l] && skew < 1e-20 * at.trace[l] * at.trace[l]) continue;
    Eigen::Quaterniond q(before[0][l], before[1][l], before[2][l], before[3][l]);
    q.normalize();
    const Eigen::Matrix3d F_lane = lane(F, l), R = math::polar_rotation(F_lane, q);
    for (int i = 0; i < 3; ++i) rotation[i + 1][l] = q.vec()(i);
    rotation[0][l] = q.w();
    set_lane(r.rotation, l, R);
    set_lane(at.inverse, l, math::polar_spin(R, F_lane));
    stretch[l] = R.cwiseProduct(F_lane).sum() - 3;
  }
  const Lanes pressure = lambda * stretch;
  const Lanes factor = 2 * mu - pressure;
  r.twist = product(product(r.rotation, at.inverse), transpose(r.rotation));
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      r.stress[i][j] = 2 * mu * F[i][j] - factor * r.rotation[i][j];
      r.twist[i][j] *= factor;
    }
  }
  return r;
}

}  // namespace palpate::bench
