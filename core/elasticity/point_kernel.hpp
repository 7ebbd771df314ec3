#pragma once

#include <Eigen/Core>
#include <array>

#include "core/elasticity/element.hpp"

namespace palpate::elasticity {

/// Four quadrature points side by side: those of one quadratic element, or of four linear ones.
using Lanes = Eigen::Array<double, 4, 1>;
using LaneMatrix = std::array<Lanes, 9>;     // row by row
using LaneSymmetric = std::array<Lanes, 6>;  // xx yy zz xy xz yz

/// What four points remember between evaluations: their rotations, from which the next search
/// starts, and their stretch S = R^T F, now and at the beginning of the time step.
struct PointState {
  std::array<Lanes, 4> rotation{Lanes::Ones(), Lanes::Zero(), Lanes::Zero(), Lanes::Zero()};
  LaneSymmetric stretch{Lanes::Ones(), Lanes::Ones(), Lanes::Ones(),
                        Lanes::Zero(), Lanes::Zero(), Lanes::Zero()};
  LaneSymmetric previous_stretch = stretch;
};

/// Rotation R of the polar decomposition of F by Newton's method on the unit quaternion
/// (Kugelstadt, Koschier and Bender 2018), from the rotation of last time; where that finds no
/// maximum of tr(R^T F), by a singular value decomposition. Leaves S = R^T F in `state` and R in
/// `R`.
void update_rotation(const LaneMatrix& F, PointState& state, LaneMatrix& R) noexcept;

/// Energy density and first Piola-Kirchhoff stress P of
///   mu |S - I|^2 + lambda/2 tr^2(S - I) + viscous (mu |S - S0|^2 + lambda/2 tr^2(S - S0)),
/// S0 being the stretch at the beginning of the step: Rayleigh damping in the turned frame, which
/// no rigid motion feels, and an exact derivative of its potential.
Lanes add_stress(const Lame& lame, double viscous, const PointState& state, const LaneMatrix& R,
                 LaneMatrix& P) noexcept;

}  // namespace palpate::elasticity
