#include "core/mesh/point_locator.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace palpate::mesh {
namespace {

using Corners = std::array<Eigen::Vector3d, 4>;

Corners corners_of(const ElementMesh& mesh, int element) {
  Corners corners;
  for (int i = 0; i < 4; ++i) corners[i] = mesh.nodes.col(mesh.elements(i, element));
  return corners;
}

/// Barycentric coordinates of p; not finite if the tetrahedron has no volume.
Eigen::Vector4d barycentric(const Corners& x, const Eigen::Vector3d& p) {
  Eigen::Matrix3d edges;
  for (int i = 0; i < 3; ++i) edges.col(i) = x[i + 1] - x[0];
  const Eigen::Vector3d b = edges.inverse() * (p - x[0]);
  return {1 - b.sum(), b[0], b[1], b[2]};
}

double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                           const Eigen::Vector3d& b) {
  const Eigen::Vector3d edge = b - a;
  const double s = std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return (p - a - s * edge).norm();
}

double distance_to_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                            const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const bool above = n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
                     n.dot((a - c).cross(p - c)) >= 0;
  if (above) return std::abs(n.dot(p - a)) / n.norm();
  return std::min(
      {distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

double distance_outside(const Corners& x, const Eigen::Vector4d& b, const Eigen::Vector3d& p) {
  if (b.minCoeff() >= 0) return 0;
  return std::min(
      {distance_to_triangle(p, x[0], x[1], x[2]), distance_to_triangle(p, x[0], x[1], x[3]),
       distance_to_triangle(p, x[0], x[2], x[3]), distance_to_triangle(p, x[1], x[2], x[3])});
}

}  // namespace

PointLocator::PointLocator(const ElementMesh& mesh) : mesh_(mesh) {
  boxes_.resize(mesh.element_count());
  for (int e = 0; e < mesh.element_count(); ++e) {
    for (const Eigen::Vector3d& corner : corners_of(mesh, e)) boxes_[e].extend(corner);
  }
}

PointWeights PointLocator::locate(const Eigen::Vector3d& p_O) const {
  int best = 0;
  Eigen::Vector4d b = Eigen::Vector4d::Constant(0.25);
  double nearest = std::numeric_limits<double>::infinity();
  for (int e = 0; e < mesh_.element_count(); ++e) {
    if (boxes_[e].exteriorDistance(p_O) > nearest) continue;
    const Corners corners = corners_of(mesh_, e);
    const Eigen::Vector4d candidate = barycentric(corners, p_O);
    if (!candidate.allFinite()) continue;
    const double outside = distance_outside(corners, candidate, p_O);
    // on a shared face: the element in which the point lies deepest
    if (outside < nearest || (outside == nearest && candidate.minCoeff() > b.minCoeff())) {
      nearest = outside;
      b = candidate;
      best = e;
    }
  }

  constexpr double kBorder = 1e-9;  // m, rounding error of a point on the boundary
  PointWeights result;
  result.outside = nearest < kBorder ? 0 : nearest;
  result.count = mesh_.nodes_per_element();
  for (int i = 0; i < result.count; ++i) result.nodes[i] = mesh_.elements(i, best);
  for (int i = 0; i < 4; ++i) {
    result.weights[i] = mesh_.order == ElementOrder::kLinear ? b[i] : b[i] * (2 * b[i] - 1);
  }
  for (int i = 4; i < result.count; ++i) {
    result.weights[i] = 4 * b[kTetrahedronEdges[i - 4][0]] * b[kTetrahedronEdges[i - 4][1]];
  }
  return result;
}

}  // namespace palpate::mesh
