#pragma once

#include <array>

namespace palpate::bench {

/// Four numbers, one for each of four elements.
using Lanes = double __attribute__((vector_size(32)));
using LaneVector = std::array<Lanes, 3>;
using LaneMatrix = std::array<LaneVector, 3>;  // row by row

/// A quadrature point of four elements.
template <int kNodes>
struct LanePoint {
  std::array<LaneVector, kNodes> gradients{};  // 1/m
  Lanes mu{}, lambda{};                        // N m: Lame's constants times the point's volume
  std::array<Lanes, 4> rotation{};             // w, x, y, z of the previous step; any length
};

/// Results from the deformation gradient F of such a point.
struct LaneResponse {
  LaneMatrix rotation, stress, twist;
};

/// Rotation R of the polar decomposition (Newton's method on the quaternion, from that of the
/// previous step; if it is not safe, a lane uses the scalar method of core/math), stress P = dE/dF
/// and the twist stiffness (2 mu - lambda tr(S - I)) R (tr(S) I - S)^-1 R^T, S = R^T F.
LaneResponse respond(const LaneMatrix& F, Lanes mu, Lanes lambda, std::array<Lanes, 4>& rotation);

}  // namespace palpate::bench
