#pragma once

#include <array>
#include <vector>

#include "core/elasticity/element_stress.hpp"
#include "core/elasticity/node_warp.hpp"
#include "core/math/rigid.hpp"

namespace palpate::elasticity {

/// How many places on the object can be asked for their response to a contact force.
inline constexpr int kContactSlots = 4;

/// How the static equilibrium follows what acts on it. xi = (displacement of the origin of G in m,
/// rotation about it in rad), both in O; w = wrench of the hand on the object at the origin of G,
/// in O. Computed for a snapshot of some ticks ago from the exact tangent, and turned with the
/// object since, but for the stress. Shapes are stacked node by node (x, y, z), zero rows for fixed
/// nodes.
struct Sensitivity {
  using Motion = Eigen::Matrix<double, Eigen::Dynamic, 6>;

  bool valid = false;
  double age = 0;  // s since the snapshot

  std::array<Motion, 2> dx_dxi;                         // by each held grasp; zero where not held
  std::array<std::array<math::Matrix6d, 2>, 2> dw_dxi;  // [a][b]: of hand a by motion of grasp b

  /// By material parameters: logarithm of Young's modulus (all elements by the same share),
  /// Poisson's ratio (all by the same amount), logarithm of density.
  enum Parameter { kLogYoung, kPoisson, kLogDensity };
  Eigen::Matrix<double, Eigen::Dynamic, 3> dx_dparameter;
  std::array<Eigen::Matrix<double, 6, 3>, 2> dw_dparameter;

  /// By a force in N, axes of O, on each contact place that has been set; zero elsewhere.
  std::array<Eigen::Matrix<double, Eigen::Dynamic, 3>, kContactSlots> dx_dforce;
  std::array<std::array<Eigen::Matrix<double, 6, 3>, kContactSlots>, 2> dw_dforce;

  /// Smallest pivot of the static tangent over its diagonal entry: falls towards zero as the object
  /// comes near to buckling (design: warn below a twentieth of its value at rest).
  double smallest_pivot = 0;

  /// At the snapshot and in the axes of that time: not turned since. Its von Mises stresses hold
  /// for whatever rigid motion has followed. Empty where the model gives none.
  ElementStress stress;

  /// Zeros for a mesh of `nodes` nodes, the stress aside. Allocates.
  void resize(int nodes);
};

/// What has turned by how much since a snapshot.
struct Turned {
  const NodeWarp& nodes;              // in a solver's numbering
  const std::vector<int>& numbering;  // of mesh nodes; beyond the warp's size: fixed
  std::array<Eigen::Matrix3d, 2> grasps{Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()};
  std::array<Eigen::Matrix3d, kContactSlots> contacts{};
  std::array<bool, 2> is_held{false, false};  // others have no columns
  std::array<bool, kContactSlots> is_watched{};
};

/// `now` = the sensitivity of a snapshot turned with its nodes, which is exact for an object that
/// has moved as a rigid body: rows of the mesh nodes `begin` to `end`, so that it can be spread
/// over ticks, and the wrenches. Copies validity; leaves age and stress alone. Sizes must agree.
void turn(const Sensitivity& snapshot, const Turned& turned, int begin, int end,
          Sensitivity& now) noexcept;

}  // namespace palpate::elasticity
