#include "core/contact/surface_edges.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace palpate::contact {
namespace {

using Eigen::Vector3d;

// rad; adjacent faces of a coarse mesh of a rounded object turn by less
const double kFlat = std::cos(0.7);

Vector3d normal_of(const Eigen::Vector3i& triangle, const Eigen::Matrix3Xd& nodes) {
  const Vector3d a = nodes.col(triangle[0]);
  return (nodes.col(triangle[1]) - a).cross(nodes.col(triangle[2]) - a).normalized();
}

}  // namespace

SurfaceEdges::SurfaceEdges(const Eigen::Matrix3Xd& rest, const mesh::Surface& surface)
    : rest_(rest) {
  std::map<std::pair<int, int>, Vector3d> sides;  // normal of the face processed first
  std::vector<std::pair<int, int>> edges;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3i triangle = surface.triangles.col(t);
    const Vector3d normal = normal_of(triangle, rest);
    for (int i = 0; i < 3; ++i) {
      const std::pair<int, int> side = std::minmax(triangle[i], triangle[(i + 1) % 3]);
      const auto [known, is_first] = sides.emplace(side, normal);
      if (!is_first && known->second.dot(normal) < kFlat) edges.push_back(side);
    }
  }
  const auto count = static_cast<Eigen::Index>(edges.size());
  from_.resize(3, count);
  along_.resize(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto& [a, b] = edges[static_cast<std::size_t>(k)];
    from_.col(k) = rest.col(a);
    along_.col(k) = rest.col(b) - rest.col(a);
  }
  squared_ = along_.colwise().squaredNorm().transpose();
}

bool SurfaceEdges::is_near(const SurfaceMatch& match, double distance) const noexcept {
  Vector3d p = Vector3d::Zero();
  for (int i = 0; i < match.count; ++i) p += match.weights[i] * rest_.col(match.nodes[i]);
  for (Eigen::Index k = 0; k < from_.cols(); ++k) {
    const Vector3d way = p - from_.col(k);
    const Vector3d along = along_.col(k);
    const double share = std::clamp(way.dot(along) / squared_[k], 0.0, 1.0);
    if ((way - share * along).squaredNorm() < distance * distance) return true;
  }
  return false;
}

}  // namespace palpate::contact
