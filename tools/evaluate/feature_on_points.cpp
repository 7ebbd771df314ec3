#include "tools/evaluate/feature_on_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "core/shape/distance_feature.hpp"
#include "core/shape/point_feature.hpp"
#include "core/shape/points_feature.hpp"
#include "core/shape/pose_feature.hpp"

namespace palpate::evaluate {
namespace {

/// m; less than what two points of a set are apart
constexpr double kSmallEdge = 0.1 * shape::kNearestPair;

/// A small tetrahedron at each point, the points first: the feature then reads nothing but them.
mesh::ElementMesh tetrahedra_at(const Eigen::Matrix3Xd& points) {
  const int n = static_cast<int>(points.cols());
  mesh::TetrahedralMesh mesh;
  mesh.nodes.resize(3, 4 * n);
  mesh.tetrahedra.resize(4, n);
  mesh.nodes.leftCols(n) = points;
  for (int i = 0; i < n; ++i) {
    mesh.tetrahedra.col(i) << i, n + 3 * i, n + 3 * i + 1, n + 3 * i + 2;
    mesh.nodes.middleCols<3>(n + 3 * i) =
        (kSmallEdge * Eigen::Matrix3d::Identity()).colwise() + points.col(i);
  }
  return mesh::make_element_mesh(mesh, mesh::ElementOrder::kLinear);
}

/// One tetrahedron with the points as its first corners.
mesh::ElementMesh tetrahedron_of(const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd corners(3, 4);
  if (points.cols() == 1) {
    corners << points.col(0), points.col(0) + Eigen::Vector3d::UnitX(),
        points.col(0) + Eigen::Vector3d::UnitY(), points.col(0) + Eigen::Vector3d::UnitZ();
  } else {
    const Eigen::Vector3d normal =
        (points.col(1) - points.col(0)).cross(points.col(2) - points.col(0)).normalized();
    corners << points, points.col(0) + (points.col(1) - points.col(0)).norm() * normal;
  }
  mesh::TetrahedralMesh mesh;
  mesh.nodes = corners;
  mesh.tetrahedra = Eigen::Vector4i(0, 1, 2, 3);
  return mesh::make_element_mesh(mesh, mesh::ElementOrder::kLinear);
}

}  // namespace

FeatureOnPoints::FeatureOnPoints(const std::string& kind,
                                 const std::vector<Eigen::Vector3d>& rest_points)
    : rest_points_(3, rest_points.size()) {
  for (std::size_t i = 0; i < rest_points.size(); ++i) rest_points_.col(i) = rest_points[i];
  if (kind == "point" && rest_points.size() == 1) {
    shape::PointFeature::Options options;
    options.rest_point = rest_points[0];
    feature_ = std::make_unique<shape::PointFeature>(tetrahedron_of(rest_points_), options);
  } else if (kind == "pose" && rest_points.size() == 3) {
    shape::PoseFeature::Options options;
    options.rest_points = {rest_points[0], rest_points[1], rest_points[2]};
    feature_ = std::make_unique<shape::PoseFeature>(tetrahedron_of(rest_points_), options);
  } else if (kind == "points") {
    feature_ = std::make_unique<shape::PointsFeature>(tetrahedra_at(rest_points_),
                                                      shape::PointsFeature::Options{rest_points});
  } else if (kind == "distance") {
    feature_ = std::make_unique<shape::DistanceFeature>(
        tetrahedra_at(rest_points_), shape::DistanceFeature::Options{rest_points});
  } else {
    throw std::invalid_argument("a feature \"" + kind + "\" of " +
                                std::to_string(rest_points.size()) + " points cannot be scored");
  }
}

Eigen::VectorXd FeatureOnPoints::value(const Eigen::Matrix3Xd& points) const {
  Eigen::Matrix3Xd corners = Eigen::Matrix3Xd::Zero(3, 4 * points.cols());
  corners.leftCols(points.cols()) = points;
  Eigen::VectorXd value(feature_->value_count());
  feature_->evaluate(corners, value);
  return value;
}

Eigen::VectorXd FeatureOnPoints::error(const Eigen::VectorXd& value,
                                       const Eigen::VectorXd& target) const {
  Eigen::VectorXd error(feature_->dimension());
  feature_->error(value, target, error);
  return error;
}

bool FeatureOnPoints::is_set() const { return std::strcmp(feature_->kind(), "points") == 0; }

double FeatureOnPoints::distance(const Eigen::VectorXd& error) const {
  if (!is_set()) return error.head(std::min<Eigen::Index>(3, error.size())).norm();
  return std::sqrt(3 * error.squaredNorm() / static_cast<double>(error.size()));
}

double FeatureOnPoints::angle(const Eigen::VectorXd& error) const {
  return !is_set() && error.size() == 6 ? error.tail<3>().norm() : 0;
}

Eigen::Vector3d FeatureOnPoints::place(const Eigen::VectorXd& value) const {
  if (value.size() == 1) return value[0] * Eigen::Vector3d::UnitX();
  if (!is_set()) return value.head<3>();
  return value.reshaped(3, value.size() / 3).rowwise().mean();
}

}  // namespace palpate::evaluate
