#include "core/mesh/point_locator.hpp"

#include <Eigen/Dense>
#include <limits>

namespace palpate::mesh {
namespace {

/// Barycentric coordinates of p in the straight-sided element e.
Eigen::Vector4d barycentric(const ElementMesh& mesh, int e, const Eigen::Vector3d& p) {
  Eigen::Matrix3d edges;
  const Eigen::Vector3d p0 = mesh.nodes.col(mesh.elements(0, e));
  for (int i = 0; i < 3; ++i) edges.col(i) = mesh.nodes.col(mesh.elements(i + 1, e)) - p0;
  const Eigen::Vector3d b = edges.inverse() * (p - p0);
  return {1 - b.sum(), b[0], b[1], b[2]};
}

/// Distance from p to the element, from below by its faces' planes: exact enough to tell which
/// element is nearest and how far outside a point is, to second order in the shape of the element.
double distance_outside(const ElementMesh& mesh, int e, const Eigen::Vector3d& p,
                        const Eigen::Vector4d& b) {
  if (b.minCoeff() >= 0) return 0;
  Eigen::Vector4d clamped = b.cwiseMax(0);
  clamped /= clamped.sum();
  Eigen::Vector3d nearest = Eigen::Vector3d::Zero();
  for (int i = 0; i < 4; ++i) nearest += clamped[i] * mesh.nodes.col(mesh.elements(i, e));
  return (p - nearest).norm();
}

}  // namespace

PointLocator::PointLocator(const ElementMesh& mesh) : mesh_(mesh) {}

PointWeights PointLocator::locate(const Eigen::Vector3d& p_O) const {
  int best = 0;
  double nearest = std::numeric_limits<double>::infinity();
  double roundness = -std::numeric_limits<double>::infinity();
  for (int e = 0; e < mesh_.element_count(); ++e) {
    const Eigen::Vector4d b = barycentric(mesh_, e, p_O);
    const double outside = distance_outside(mesh_, e, p_O, b);
    // Inside or on the border of several: the one that holds it most deeply.
    if (outside < nearest || (outside == nearest && b.minCoeff() > roundness)) {
      nearest = outside;
      roundness = b.minCoeff();
      best = e;
    }
  }
  constexpr double kBorder = 1e-9;  // m, rounding of a point on the border
  const Eigen::Vector4d b = barycentric(mesh_, best, p_O);
  PointWeights result;
  result.outside = nearest < kBorder ? 0 : nearest;
  result.count = mesh_.nodes_per_element();
  for (int i = 0; i < result.count; ++i) result.nodes[i] = mesh_.elements(i, best);
  if (mesh_.order == ElementOrder::kLinear) {
    for (int i = 0; i < 4; ++i) result.weights[i] = b[i];
    return result;
  }
  constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  for (int i = 0; i < 4; ++i) result.weights[i] = b[i] * (2 * b[i] - 1);
  for (int e = 0; e < 6; ++e) result.weights[4 + e] = 4 * b[kEdges[e][0]] * b[kEdges[e][1]];
  return result;
}

}  // namespace palpate::mesh
