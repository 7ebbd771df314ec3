#include "core/shape/points_feature.hpp"

#include <algorithm>

#include "core/mesh/surface.hpp"

namespace palpate::shape {

PointsFeature::PointsFeature(const mesh::ElementMesh& mesh, const Options& options)
    : MaterialFeature(mesh, checked_points("points", options.rest_points, 1, kMostPoints)) {
  set_constant(Eigen::MatrixXd::Identity(3 * point_count(), 3 * point_count()));
}

void PointsFeature::evaluate(const Eigen::Matrix3Xd& positions,
                             Eigen::Ref<Eigen::VectorXd> value) noexcept {
  for (int p = 0; p < point_count(); ++p) value.segment<3>(3 * p) = position(p, positions);
}

std::vector<Eigen::Vector3d> surface_points(const mesh::ElementMesh& mesh, int count) {
  const Eigen::Matrix3Xi triangles = mesh::extract_surface(mesh).triangles;
  std::vector<int> nodes(triangles.data(), triangles.data() + triangles.size());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::sort(nodes.begin(), nodes.end(), [&](int a, int b) {
    const auto p = mesh.nodes.col(a);
    const auto q = mesh.nodes.col(b);
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  });

  std::vector<Eigen::Vector3d> chosen;
  std::vector<double> distance(nodes.size(), std::numeric_limits<double>::infinity());
  while (static_cast<int>(chosen.size()) < count) {
    const auto farthest = std::max_element(distance.begin(), distance.end());
    if (farthest == distance.end() || *farthest < kNearestPair) break;
    chosen.emplace_back(mesh.nodes.col(nodes[farthest - distance.begin()]));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      distance[i] = std::min(distance[i], (mesh.nodes.col(nodes[i]) - chosen.back()).norm());
    }
  }
  return chosen;
}

}  // namespace palpate::shape
