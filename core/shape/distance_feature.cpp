#include "core/shape/distance_feature.hpp"

namespace palpate::shape {

DistanceFeature::DistanceFeature(const mesh::ElementMesh& mesh, const Options& options)
    : MaterialFeature(mesh, checked_points("distance", options.rest_points, 2, 2)) {
  set_dimension(1);
  Eigen::VectorXd value(1);
  evaluate(mesh.nodes, value);
}

void DistanceFeature::evaluate(const Eigen::Matrix3Xd& positions,
                               Eigen::Ref<Eigen::VectorXd> value) noexcept {
  const Eigen::Vector3d edge = position(1, positions) - position(0, positions);
  value[0] = edge.norm();
  is_defined_ = value[0] > kShortestEdge;
  if (!is_defined_) return;
  Eigen::Matrix<double, 1, 6> by_points;
  by_points << -edge.transpose(), edge.transpose();
  by_points /= value[0];
  chain(by_points);
}

bool DistanceFeature::is_valid_target(const double* target, int count) const noexcept {
  return MaterialFeature::is_valid_target(target, count) && target[0] >= 0;
}

}  // namespace palpate::shape
