#pragma once

#include "core/mesh/surface.hpp"

namespace palpate::contact {

/// A point of a triangulated surface.
struct SurfacePoint {
  int triangle = -1;                                   // -1: the surface is empty
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();   // of its corners: areal, >= 0, sum 1
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  double distance = 0;                                 // m, from the point asked for, unsigned
};

/// Point of the triangle a, b, c nearest to `p` (Ericson 2005, 5.1.5); `triangle` stays -1. A
/// triangle without area gives its nearest edge or corner.
SurfacePoint closest_point_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b, const Eigen::Vector3d& c) noexcept;

/// Point of the deformed surface nearest to `p`; the surface is that of the corner nodes, flat
/// between them. positions: 3 x n, m. Exhaustive, with a cheap rejection by bounding boxes.
SurfacePoint closest_point_on_surface(const Eigen::Vector3d& p, const Eigen::Matrix3Xi& triangles,
                                      const Eigen::Matrix3Xd& positions) noexcept;

}  // namespace palpate::contact
