#include "tools/lab/runs/feature_on_points.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/shape/angle_feature.hpp"
#include "core/shape/curvature_feature.hpp"
#include "core/shape/fourier_contour_feature.hpp"
#include "core/shape/point_features.hpp"
#include "core/shape/pose_feature.hpp"

namespace palpate::runs {
namespace {

/// m; less than the distance of two points of a set
constexpr double kSmallEdge = 0.1 * shape::kNearestPair;

/// A small tetrahedron at each point, with the points as first corners: the feature then depends
/// only on them.
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

std::unique_ptr<shape::Feature> make_feature(const FeatureDefinition& definition,
                                             const Eigen::Matrix3Xd& points) {
  const std::vector<Eigen::Vector3d>& rest_points = definition.rest_points;
  const std::string& kind = definition.kind;
  if (kind == "point" && rest_points.size() == 1) {
    shape::PointFeature::Options options;
    options.rest_point = rest_points[0];
    return std::make_unique<shape::PointFeature>(tetrahedron_of(points), options);
  }
  if (kind == "pose" && rest_points.size() == 3) {
    shape::PoseFeature::Options options;
    options.rest_points = {rest_points[0], rest_points[1], rest_points[2]};
    return std::make_unique<shape::PoseFeature>(tetrahedron_of(points), options);
  }
  const mesh::ElementMesh mesh = tetrahedra_at(points);
  if (kind == "points")
    return std::make_unique<shape::PointsFeature>(mesh, shape::PointsFeature::Options{rest_points});
  if (kind == "distance")
    return std::make_unique<shape::DistanceFeature>(mesh,
                                                    shape::DistanceFeature::Options{rest_points});
  if (kind == "angle")
    return std::make_unique<shape::AngleFeature>(
        mesh, shape::AngleFeature::Options{rest_points, definition.axis});
  if (kind == "curvature")
    return std::make_unique<shape::CurvatureFeature>(
        mesh, shape::CurvatureFeature::Options{rest_points, definition.axis});
  if (kind == "fourier_contour")
    return std::make_unique<shape::FourierContourFeature>(
        mesh, shape::FourierContourFeature::Options{rest_points, definition.harmonics,
                                                    definition.closed, definition.components});
  throw std::invalid_argument("a feature \"" + kind + "\" of " +
                              std::to_string(rest_points.size()) + " points cannot be scored");
}

}  // namespace

FeatureOnPoints::FeatureOnPoints(const FeatureDefinition& definition)
    : definition_(definition), rest_points_(3, definition.rest_points.size()) {
  for (Eigen::Index i = 0; i < rest_points_.cols(); ++i)
    rest_points_.col(i) = definition.rest_points[static_cast<std::size_t>(i)];
  feature_ = make_feature(definition, rest_points_);
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

bool FeatureOnPoints::is(const char* kind) const { return definition_.kind == kind; }

bool FeatureOnPoints::is_distance() const { return !is("angle") && !is("curvature"); }

double FeatureOnPoints::distance(const Eigen::VectorXd& error) const {
  if (!is_distance()) return 0;
  if (is("points")) return std::sqrt(3 * error.squaredNorm() / static_cast<double>(error.size()));
  if (!is("fourier_contour")) return error.head(std::min<Eigen::Index>(3, error.size())).norm();
  // The mean square of cosines and sines is half that of a constant.
  const auto parts = static_cast<Eigen::Index>(definition_.components.size());
  const auto coefficients = error.reshaped(error.size() / parts, parts);
  return std::sqrt(0.5 * (coefficients.squaredNorm() + coefficients.row(0).squaredNorm()));
}

double FeatureOnPoints::angle(const Eigen::VectorXd& error) const {
  if (is("angle")) return std::abs(error[0]);
  return is("pose") ? error.tail<3>().norm() : 0;
}

double FeatureOnPoints::size(const Eigen::VectorXd& error) const {
  return is_distance() ? distance(error) : std::abs(error[0]);
}

Eigen::Vector3d FeatureOnPoints::place(const Eigen::VectorXd& value) const {
  if (value.size() == 1) return value[0] * Eigen::Vector3d::UnitX();
  if (is("points")) return value.reshaped(3, value.size() / 3).rowwise().mean();
  if (!is("fourier_contour")) return value.head<3>();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto parts = static_cast<Eigen::Index>(definition_.components.size());
  for (Eigen::Index i = 0; i < parts; ++i)
    mean[definition_.components[static_cast<std::size_t>(i)]] = value[i * value.size() / parts];
  return mean;
}

}  // namespace palpate::runs
