#include "core/mesh/closest_point.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace palpate::mesh {
namespace {

/// Parameter in [0, 1] of the point of the segment from `a` to `b` nearest to `p`.
double along_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                     const Eigen::Vector3d& b) noexcept {
  const double length_squared = (b - a).squaredNorm();
  if (!(length_squared > 0)) return 0;
  return std::clamp((p - a).dot(b - a) / length_squared, 0.0, 1.0);
}

}  // namespace

SurfacePoint closest_point_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b,
                                       const Eigen::Vector3d& c) noexcept {
  SurfacePoint found;
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area_squared = normal.squaredNorm();
  const double longest = std::max((b - a).squaredNorm(), (c - a).squaredNorm());
  if (area_squared > 1e-20 * longest * longest) {
    const double v = (p - a).cross(c - a).dot(normal) / area_squared;
    const double w = (b - a).cross(p - a).dot(normal) / area_squared;
    if (v >= 0 && w >= 0 && v + w <= 1) {
      found.weights << std::max(0.0, 1 - v - w), v, w;
      found.position = found.weights[0] * a + v * b + w * c;
      found.distance = (p - found.position).norm();
      return found;
    }
  }
  // outside, or no area: search the three edges
  const Eigen::Vector3d* const corners[3] = {&a, &b, &c};
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double t = along_segment(p, *corners[i], *corners[j]);
    const Eigen::Vector3d q = (1 - t) * *corners[i] + t * *corners[j];
    const double distance = (p - q).norm();
    if (!(distance < least)) continue;
    least = distance;
    found.position = q;
    found.distance = distance;
    found.weights.setZero();
    found.weights[i] = 1 - t;
    found.weights[j] = t;
  }
  return found;
}

SurfacePoint closest_point_on_surface(const Eigen::Vector3d& p, const Eigen::Matrix3Xi& triangles,
                                      const Eigen::Matrix3Xd& positions) noexcept {
  SurfacePoint best;
  best.distance = std::numeric_limits<double>::infinity();
  for (int t = 0; t < triangles.cols(); ++t) {
    const auto a = positions.col(triangles(0, t));
    const auto b = positions.col(triangles(1, t));
    const auto c = positions.col(triangles(2, t));
    const Eigen::Vector3d lower = a.cwiseMin(b).cwiseMin(c);
    const Eigen::Vector3d upper = a.cwiseMax(b).cwiseMax(c);
    const double to_box = (lower - p).cwiseMax(p - upper).cwiseMax(0.0).norm();
    if (!(to_box < best.distance)) continue;
    SurfacePoint candidate = closest_point_on_triangle(p, a, b, c);
    if (!(candidate.distance < best.distance)) continue;
    best = candidate;
    best.triangle = t;
  }
  return best;
}

}  // namespace palpate::mesh
