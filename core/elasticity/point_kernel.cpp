#include "core/elasticity/point_kernel.hpp"

#include <Eigen/Geometry>

#include "core/math/polar.hpp"

namespace palpate::elasticity {
namespace {

constexpr int kMaxNewton = 8;
// After a turn by w what is left is of order w^2 times the strain, here less than 1e-14.
constexpr double kSmallTurn2 = 1e-14;

struct Inverse {
  LaneSymmetric adjugate;
  Lanes determinant;
  Eigen::Array<bool, 4, 1> positive;
};

/// Of H = tr(S) I - S, the negative second derivative of tr(R^T F) by a turn of R.
Inverse invert_turn_stiffness(const LaneSymmetric& S) {
  const Lanes xx = S[1] + S[2], yy = S[0] + S[2], zz = S[0] + S[1];
  const Lanes xy = -S[3], xz = -S[4], yz = -S[5];
  Inverse out;
  out.adjugate = {yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy,
                  xz * yz - xy * zz, xy * yz - xz * yy, xy * xz - xx * yz};
  out.determinant = xx * out.adjugate[0] + xy * out.adjugate[3] + xz * out.adjugate[4];
  out.positive = xx > 0 && out.adjugate[2] > 0 && out.determinant > 1e-9;
  return out;
}

std::array<Lanes, 3> times(const LaneSymmetric& A, const std::array<Lanes, 3>& v) {
  return {A[0] * v[0] + A[3] * v[1] + A[4] * v[2], A[3] * v[0] + A[1] * v[1] + A[5] * v[2],
          A[4] * v[0] + A[5] * v[1] + A[2] * v[2]};
}

void rotation_matrix(const std::array<Lanes, 4>& q, LaneMatrix& R) {
  const Lanes x2 = q[1] + q[1], y2 = q[2] + q[2], z2 = q[3] + q[3];
  const Lanes xx = q[1] * x2, yy = q[2] * y2, zz = q[3] * z2;
  const Lanes xy = q[1] * y2, xz = q[1] * z2, yz = q[2] * z2;
  const Lanes wx = q[0] * x2, wy = q[0] * y2, wz = q[0] * z2;
  R[0] = 1 - yy - zz;
  R[1] = xy - wz;
  R[2] = xz + wy;
  R[3] = xy + wz;
  R[4] = 1 - xx - zz;
  R[5] = yz - wx;
  R[6] = xz - wy;
  R[7] = yz + wx;
  R[8] = 1 - xx - yy;
}

/// S = sym(R^T F), g = vee(R^T F - F^T R).
void stretch(const LaneMatrix& R, const LaneMatrix& F, LaneSymmetric& S, std::array<Lanes, 3>& g) {
  const auto dot = [&](int i, int j) -> Lanes {
    return R[i] * F[j] + R[3 + i] * F[3 + j] + R[6 + i] * F[6 + j];
  };
  const Lanes b01 = dot(0, 1), b10 = dot(1, 0), b02 = dot(0, 2), b20 = dot(2, 0);
  const Lanes b12 = dot(1, 2), b21 = dot(2, 1);
  S = {dot(0, 0), dot(1, 1), dot(2, 2), 0.5 * (b01 + b10), 0.5 * (b02 + b20), 0.5 * (b12 + b21)};
  g = {b21 - b12, b02 - b20, b10 - b01};
}

/// q <- q * (1, w/2), normalised: a turn by |w| in the frame of the point, to third order.
void turn(const std::array<Lanes, 3>& w, std::array<Lanes, 4>& q) {
  const Lanes a = 0.5 * w[0], b = 0.5 * w[1], c = 0.5 * w[2];
  const std::array<Lanes, 4> r{
      q[0] - q[1] * a - q[2] * b - q[3] * c, q[1] + q[0] * a + q[2] * c - q[3] * b,
      q[2] + q[0] * b + q[3] * a - q[1] * c, q[3] + q[0] * c + q[1] * b - q[2] * a};
  const Lanes scale = 1 / (r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]).sqrt();
  for (int k = 0; k < 4; ++k) q[k] = r[k] * scale;
}

void rescue(const LaneMatrix& F, int lane, std::array<Lanes, 4>& q) {
  Eigen::Matrix3d f;
  for (int k = 0; k < 9; ++k) f(k / 3, k % 3) = F[k](lane);
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  if (f.allFinite()) rotation = Eigen::Quaterniond(math::polar_rotation(f)).normalized();
  q[0](lane) = rotation.w();
  q[1](lane) = rotation.x();
  q[2](lane) = rotation.y();
  q[3](lane) = rotation.z();
}

}  // namespace

void update_rotation(const LaneMatrix& F, PointState& state, LaneMatrix& R) noexcept {
  std::array<Lanes, 3> g;
  for (int i = 0;; ++i) {
    rotation_matrix(state.rotation, R);
    stretch(R, F, state.stretch, g);
    const Inverse h = invert_turn_stiffness(state.stretch);
    std::array<Lanes, 3> w = times(h.adjugate, g);
    const Lanes scale = 1 / h.determinant;
    for (Lanes& component : w) component *= scale;
    const Lanes turn2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
    const Eigen::Array<bool, 4, 1> near = h.positive && turn2 < kSmallTurn2;
    if (near.all()) {
      turn(w, state.rotation);
      break;
    }
    if (i == kMaxNewton || !h.positive.all()) {
      for (int lane = 0; lane < 4; ++lane) {
        if (!near(lane)) rescue(F, lane, state.rotation);
      }
      break;
    }
    turn(w, state.rotation);
  }
  rotation_matrix(state.rotation, R);
  stretch(R, F, state.stretch, g);
}

Lanes add_stress(const Lame& lame, double viscous, const PointState& state, const LaneMatrix& R,
                 LaneMatrix& P) noexcept {
  const double mu2 = 2 * lame.mu;
  const LaneSymmetric& S = state.stretch;
  const LaneSymmetric E{S[0] - 1, S[1] - 1, S[2] - 1, S[3], S[4], S[5]};
  const Lanes trace = E[0] + E[1] + E[2];
  const auto square = [](const LaneSymmetric& A) -> Lanes {
    return A[0] * A[0] + A[1] * A[1] + A[2] * A[2] + 2 * (A[3] * A[3] + A[4] * A[4] + A[5] * A[5]);
  };
  Lanes energy = lame.mu * square(E) + (0.5 * lame.lambda) * trace * trace;
  LaneMatrix T;  // R^T P
  const Lanes pressure = lame.lambda * trace;
  T[0] = mu2 * E[0] + pressure;
  T[4] = mu2 * E[1] + pressure;
  T[8] = mu2 * E[2] + pressure;
  T[1] = T[3] = mu2 * E[3];
  T[2] = T[6] = mu2 * E[4];
  T[5] = T[7] = mu2 * E[5];

  if (viscous > 0) {
    const LaneSymmetric& Z = state.previous_stretch;
    const LaneSymmetric D{S[0] - Z[0], S[1] - Z[1], S[2] - Z[2],
                          S[3] - Z[3], S[4] - Z[4], S[5] - Z[5]};
    const Lanes rate = D[0] + D[1] + D[2];
    energy += viscous * (lame.mu * square(D) + (0.5 * lame.lambda) * rate * rate);
    // Z does not turn with the point, so the turn that dF causes works against the commutator of Z
    // and S: c = vee(Z S - S Z).
    const std::array<Lanes, 3> c{
        Z[4] * S[3] + Z[5] * S[1] + Z[2] * S[5] - (Z[3] * S[4] + Z[1] * S[5] + Z[5] * S[2]),
        Z[0] * S[4] + Z[3] * S[5] + Z[4] * S[2] - (Z[4] * S[0] + Z[5] * S[3] + Z[2] * S[4]),
        Z[3] * S[0] + Z[1] * S[3] + Z[5] * S[4] - (Z[0] * S[3] + Z[3] * S[1] + Z[4] * S[5])};
    const Inverse h = invert_turn_stiffness(S);
    const Lanes scale = h.positive.select(mu2 / h.determinant, Lanes::Zero());
    std::array<Lanes, 3> w = times(h.adjugate, c);
    for (Lanes& component : w) component *= viscous * scale;
    const Lanes viscous_pressure = (viscous * lame.lambda) * rate;
    const double m = viscous * mu2;
    T[0] += m * D[0] + viscous_pressure;
    T[4] += m * D[1] + viscous_pressure;
    T[8] += m * D[2] + viscous_pressure;
    T[1] += m * D[3] - w[2];
    T[3] += m * D[3] + w[2];
    T[2] += m * D[4] + w[1];
    T[6] += m * D[4] - w[1];
    T[5] += m * D[5] - w[0];
    T[7] += m * D[5] + w[0];
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      P[3 * i + j] = R[3 * i] * T[j] + R[3 * i + 1] * T[3 + j] + R[3 * i + 2] * T[6 + j];
    }
  }
  return energy;
}

}  // namespace palpate::elasticity
