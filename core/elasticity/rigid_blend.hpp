#pragma once

#include <array>

#include "core/elasticity/body.hpp"

namespace palpate::elasticity {

/// A smooth shape that fits what holds the object, without mechanics: each node moves with the
/// nearer of the hands and the test rig, blended by the squares of their distances at rest. An
/// unstressed body moved as a whole stays unstressed; nothing is turned inside out as long as hands
/// are not.
class RigidBlend {
 public:
  explicit RigidBlend(const Body& body);

  /// Position of a node when hands that are held have moved by `motions` from rest.
  Eigen::Vector3d position(int node, const std::array<bool, 2>& held,
                           const std::array<math::Pose, 2>& motions) const noexcept;

 private:
  Eigen::Matrix3Xd rest_;
  Eigen::Matrix3Xd distance2_;  // m^2, of each node to patch 0, patch 1 and the fixed nodes
};

}  // namespace palpate::elasticity
