#include "core/shape/point_features.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/mesh/surface.hpp"

namespace palpate::shape {

const std::vector<int>& checked_components(const char* kind, const std::vector<int>& components) {
  std::vector<int> sorted = components;
  std::sort(sorted.begin(), sorted.end());
  const bool different = std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
  if (sorted.empty() || !different || sorted.front() < 0 || sorted.back() > 2) {
    std::string given;
    for (const int component : components) given += " " + std::to_string(component);
    throw std::invalid_argument("feature " + std::string(kind) + ": components:" + given +
                                "; allowed: distinct values of 0, 1, 2");
  }
  return components;
}

PointFeature::PointFeature(const mesh::ElementMesh& mesh, const Options& options)
    : MaterialFeature(mesh, {options.rest_point}),
      components_(checked_components("point", options.components)) {
  Eigen::MatrixXd by_point = Eigen::MatrixXd::Zero(components_.size(), 3);
  for (int row = 0; row < by_point.rows(); ++row) by_point(row, components_[row]) = 1;
  set_constant(by_point);
}

void PointFeature::evaluate(const Eigen::Matrix3Xd& positions,
                            Eigen::Ref<Eigen::VectorXd> value) noexcept {
  value = position(0, positions);
}

void PointFeature::error(const Eigen::Ref<const Eigen::VectorXd>& value,
                         const Eigen::Ref<const Eigen::VectorXd>& target,
                         Eigen::Ref<Eigen::VectorXd> error) const noexcept {
  for (int row = 0; row < dimension(); ++row) {
    error[row] = target[components_[row]] - value[components_[row]];
  }
}

PointsFeature::PointsFeature(const mesh::ElementMesh& mesh, const Options& options)
    : MaterialFeature(mesh, checked_points("points", options.rest_points, 1, kMostPoints)) {
  set_constant(Eigen::MatrixXd::Identity(3 * point_count(), 3 * point_count()));
}

void PointsFeature::evaluate(const Eigen::Matrix3Xd& positions,
                             Eigen::Ref<Eigen::VectorXd> value) noexcept {
  for (int p = 0; p < point_count(); ++p) value.segment<3>(3 * p) = position(p, positions);
}

std::vector<Eigen::Vector3d> surface_points(const mesh::ElementMesh& mesh, int count) {
  return surface_points(mesh, mesh::extract_surface(mesh).triangles, count);
}

std::vector<Eigen::Vector3d> surface_points(const mesh::ElementMesh& mesh,
                                            const Eigen::Matrix3Xi& triangles, int count) {
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
