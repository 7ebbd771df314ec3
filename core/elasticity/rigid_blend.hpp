#pragma once

#include <array>

#include "core/elasticity/body.hpp"

namespace palpate::elasticity {

/// Smooth shape that satisfies the boundary conditions, without mechanics: each node moves with the
/// hands and the test rig, blended by the inverse squares of their distances at rest. A rigidly
/// moved body remains unstressed; no element is inverted if the motions of the hands are moderate.
class RigidBlend {
 public:
  explicit RigidBlend(const Body& body);

  /// Position of a node when held hands have moved by `motions` from rest.
  Eigen::Vector3d position(int node, const std::array<bool, 2>& held,
                           const std::array<math::Pose, 2>& motions) const noexcept;

 private:
  Eigen::Matrix3Xd rest_;
  /// m^2, squared distance of each node from patch 0, patch 1 and the fixed nodes
  Eigen::Matrix3Xd distance2_;
};

}  // namespace palpate::elasticity
