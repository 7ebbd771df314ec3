#include "core/shape/angle_feature.hpp"

#include <cmath>

namespace palpate::shape {
namespace {

/// The two directions of four points may share a point, or nearly so.
const std::vector<Eigen::Vector3d>& checked(const std::vector<Eigen::Vector3d>& points) {
  if (points.size() != 4) return checked_points("angle", points, 3, 4);
  checked_points("angle", {points[0], points[1]}, 2, 2);
  checked_points("angle", {points[2], points[3]}, 2, 2);
  return points;
}

}  // namespace

AngleFeature::AngleFeature(const mesh::ElementMesh& mesh, const Options& options)
    : MaterialFeature(mesh, checked(options.rest_points)), axis_(unit_axis("angle", options.axis)) {
  set_dimension(1);
  Eigen::VectorXd value(1);
  evaluate(mesh.nodes, value);
  if (!is_defined_) {
    reject_points("angle", rest_points(),
                  axis_ ? "directions that are not along the axis"
                        : "directions that are not on one line, or an axis about which the angle "
                          "has a sign");
  }
}

void AngleFeature::evaluate(const Eigen::Matrix3Xd& positions,
                            Eigen::Ref<Eigen::VectorXd> value) noexcept {
  const Eigen::Vector3d p1 = position(0, positions);
  const Eigen::Vector3d p2 = position(1, positions);
  const Eigen::Vector3d p3 = position(2, positions);
  if (point_count() == 3) {
    is_defined_ = measure(p1 - p2, p3 - p2);
    Eigen::Matrix<double, 1, 9> by_points;
    by_points << by_a_, -by_a_ - by_b_, by_b_;
    if (is_defined_) chain(by_points);
  } else {
    is_defined_ = measure(p2 - p1, position(3, positions) - p3);
    Eigen::Matrix<double, 1, 12> by_points;
    by_points << -by_a_, by_a_, -by_b_, by_b_;
    if (is_defined_) chain(by_points);
  }
  value[0] = angle_;
}

/// Rotation of a direction: its displacement along m, the tangential direction in the plane of
/// both, divided by its length: d angle = (m x b / |b|^2) . db - (m x a / |a|^2) . da.
bool AngleFeature::measure(const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept {
  Eigen::Vector3d m, a_seen = a, b_seen = b;
  if (axis_) {
    m = *axis_;
    a_seen -= m.dot(a) * m;
    b_seen -= m.dot(b) * m;
    if (!(a_seen.norm() > kFlattest * a.norm() && b_seen.norm() > kFlattest * b.norm())) {
      return false;
    }
  } else {
    m = a.cross(b);
    const double area = m.norm();
    if (!(area > kFlattest * a.norm() * b.norm())) return false;
    m /= area;
  }
  if (!(a.norm() > kShortestEdge && b.norm() > kShortestEdge)) return false;
  angle_ = std::atan2(m.dot(a_seen.cross(b_seen)), a_seen.dot(b_seen));
  by_a_ = -m.cross(a_seen).transpose() / a_seen.squaredNorm();
  by_b_ = m.cross(b_seen).transpose() / b_seen.squaredNorm();
  return true;
}

void AngleFeature::error(const Eigen::Ref<const Eigen::VectorXd>& value,
                         const Eigen::Ref<const Eigen::VectorXd>& target,
                         Eigen::Ref<Eigen::VectorXd> error) const noexcept {
  error[0] = target[0] - value[0];
  if (axis_) error[0] -= 2 * M_PI * std::floor((error[0] + M_PI) / (2 * M_PI));
}

bool AngleFeature::is_valid_target(const double* target, int count) const noexcept {
  return MaterialFeature::is_valid_target(target, count) && target[0] <= M_PI &&
         target[0] >= (axis_ ? -M_PI : 0);
}

}  // namespace palpate::shape
