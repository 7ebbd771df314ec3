#pragma once

#include "core/mesh/surface.hpp"

namespace palpate::mesh {

/// Point on a triangulated surface.
struct SurfacePoint {
  int triangle = -1;  // -1: the surface is empty
  /// Areal coordinates of its corners, >= 0, sum 1.
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  double distance = 0;                                 // m, from the query point, unsigned
};

/// Point of the triangle a, b, c nearest to `p` (Ericson 2005, 5.1.5); `triangle` remains -1. For a
/// triangle without area: a point of its nearest edge or corner.
SurfacePoint closest_point_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b, const Eigen::Vector3d& c) noexcept;

/// Point of the deformed surface nearest to `p`, where the surface consists of the corner nodes'
/// flat triangles. positions: 3 x n, m. Exhaustive search with rejection by bounding boxes.
SurfacePoint closest_point_on_surface(const Eigen::Vector3d& p, const Eigen::Matrix3Xi& triangles,
                                      const Eigen::Matrix3Xd& positions) noexcept;

}  // namespace palpate::mesh
