#include "core/collision/surface_samples.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace palpate::collision {
namespace {

constexpr double kSpacingsPerRadius = 6;  // a chord deviates by spacing^2 / (8 radius)
constexpr double kSpacingsPerHalfEdge = 3;
constexpr double kCellsPerSpacing = 3;  // of a grid, which rounds edges by about a cell
constexpr double kFinest = 24;          // spacings to an edge of a face

struct Spacing {
  double operator()(const HalfSpace& /*plane*/) const {
    return std::numeric_limits<double>::infinity();
  }
  double operator()(const Box& box) const {
    return box.half_size.minCoeff() / kSpacingsPerHalfEdge;
  }
  double operator()(const Sphere& sphere) const { return sphere.radius / kSpacingsPerRadius; }
  double operator()(const Cylinder& cylinder) const { return cylinder.radius / kSpacingsPerRadius; }
  double operator()(const Capsule& capsule) const { return capsule.radius / kSpacingsPerRadius; }
  double operator()(const std::shared_ptr<const DistanceGrid>& grid) const {
    return kCellsPerSpacing * grid->cell();
  }
};

/// Point of a face with areal coordinates L, without the nodes that have no weight there.
mesh::PointWeights point_on(const std::vector<int>& face, const Eigen::Vector3d& L) {
  constexpr double kNone = 1e-12;
  mesh::PointWeights point;
  const auto add = [&](int node, double weight) {
    if (std::abs(weight) < kNone) return;
    point.nodes[point.count] = node;
    point.weights[point.count++] = weight;
  };
  const bool quadratic = face.size() == 6;
  for (int i = 0; i < 3; ++i) add(face[i], quadratic ? L[i] * (2 * L[i] - 1) : L[i]);
  for (int i = 0; quadratic && i < 3; ++i) add(face[3 + i], 4 * L[i] * L[(i + 1) % 3]);
  return point;
}

/// Identical for the same point of neighbouring faces.
std::vector<std::pair<int, long>> key_of(const mesh::PointWeights& point) {
  std::vector<std::pair<int, long>> key;
  for (int i = 0; i < point.count; ++i)
    key.emplace_back(point.nodes[i], std::lround(1e6 * point.weights[i]));
  std::sort(key.begin(), key.end());
  return key;
}

}  // namespace

double sample_spacing(const Obstacle& obstacle) noexcept {
  return std::visit(Spacing(), obstacle.shape);
}

std::vector<mesh::PointWeights> surface_samples(const mesh::Surface& surface,
                                                const Eigen::Matrix3Xd& rest, double spacing) {
  std::vector<mesh::PointWeights> samples;
  std::set<std::vector<std::pair<int, long>>> known;
  const auto add = [&](const mesh::PointWeights& point) {
    if (known.insert(key_of(point)).second) samples.push_back(point);
  };
  for (int node : surface.nodes) {
    mesh::PointWeights point;
    point.count = 1;
    point.nodes[0] = node;
    point.weights[0] = 1;
    add(point);
  }
  for (const std::vector<int>& face : surface.triangle_nodes) {
    double longest = 0;
    for (int i = 0; i < 3; ++i)
      longest = std::max(longest, (rest.col(face[i]) - rest.col(face[(i + 1) % 3])).norm());
    const int fewest = face.size() == 6 ? 3 : 1;  // three to an edge: one point inside
    const int cuts =
        std::max(fewest, static_cast<int>(std::min(std::ceil(longest / spacing), kFinest)));
    for (int i = 0; i <= cuts; ++i) {
      for (int j = 0; j <= cuts - i; ++j) {
        const bool inside = i > 0 && j > 0 && i + j < cuts;
        if (cuts == fewest && !inside) continue;
        add(point_on(face, Eigen::Vector3d(i, j, cuts - i - j) / cuts));
      }
    }
  }
  return samples;
}

}  // namespace palpate::collision
