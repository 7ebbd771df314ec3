#pragma once

#include "core/mesh/point_locator.hpp"

namespace palpate::fit {

/// A marker on a stalk that stays perpendicular to the surface of a box of quadratic elements.
class SurfaceMarker {
 public:
  /// Located at `place` off the box from `corner` to `corner` + `size` that the locator's mesh
  /// fills, on the closest point of the surface (or on the face from which it is farthest).
  SurfaceMarker(const mesh::PointLocator& locator, const Eigen::Vector3d& corner,
                const Eigen::Vector3d& size, const Eigen::Vector3d& place);

  Eigen::Vector3d position(const Eigen::Matrix3Xd& x) const;
  /// Derivative of position() for displacements dx of the nodes at x.
  Eigen::Vector3d slope(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& dx) const;

 private:
  /// Vector between two points of the material.
  struct Span {
    mesh::PointWeights ahead, behind;
    Eigen::Vector3d of(const Eigen::Matrix3Xd& x) const {
      return ahead.interpolate(x) - behind.interpolate(x);
    }
  };

  mesh::PointWeights foot_;
  Span first_, second_;  // along the surface
  double stand_ = 0;     // m, along first x second
};

}  // namespace palpate::fit
