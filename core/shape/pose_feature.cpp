#include "core/shape/pose_feature.hpp"

#include <cmath>

namespace palpate::shape {
namespace {

bool spans_plane(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double size = a.norm() * b.norm();
  return size > 1e-12 && a.cross(b).norm() > kFlattest * size;
}

}  // namespace

PoseFeature::PoseFeature(const mesh::ElementMesh& mesh, const Options& options)
    : MaterialFeature(mesh, {options.rest_points.begin(), options.rest_points.end()}) {
  const std::vector<Eigen::Vector3d>& p = rest_points();
  if (!spans_plane(p[1] - p[0], p[2] - p[0]))
    reject_points("pose", p, "points that are not on one line");
  set_dimension(6);
  const Eigen::Matrix3d third = Eigen::Matrix3d::Identity() / 3;
  by_points_.topRows<3>() << third, third, third;
  Eigen::VectorXd value(7);
  evaluate(mesh.nodes, value);
}

void PoseFeature::evaluate(const Eigen::Matrix3Xd& positions,
                           Eigen::Ref<Eigen::VectorXd> value) noexcept {
  const Eigen::Vector3d p1 = position(0, positions);
  const Eigen::Vector3d p2 = position(1, positions);
  const Eigen::Vector3d p3 = position(2, positions);
  is_defined_ = spans_plane(p2 - p1, p3 - p1);
  if (is_defined_) turn_with(p2 - p1, p3 - p1);
  value.head<3>() = (p1 + p2 + p3) / 3;
  math::wxyz_from_rotation(R_OC_, value.data() + 3);
}

/// Orientation from the edges a = p2 - p1, b = p3 - p1 and its derivative. From dx = w x x and dz =
/// w x z, with n = a x b, the rotation is
///   dw/da = x (y x b)^T / |n| + (z y^T - y z^T) / |a|,   dw/db = -x (y x a)^T / |n|.
void PoseFeature::turn_with(const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept {
  const Eigen::Vector3d n = a.cross(b);
  const Eigen::Vector3d x = a.normalized();
  const Eigen::Vector3d z = n.normalized();
  const Eigen::Vector3d y = z.cross(x);
  R_OC_ << x, y, z;

  const Eigen::Matrix3d by_a =
      x * y.cross(b).transpose() / n.norm() + (z * y.transpose() - y * z.transpose()) / a.norm();
  const Eigen::Matrix3d by_b = -x * y.cross(a).transpose() / n.norm();
  by_points_.bottomRows<3>() << -by_a - by_b, by_a, by_b;
  chain(by_points_);
}

void PoseFeature::error(const Eigen::Ref<const Eigen::VectorXd>& value,
                        const Eigen::Ref<const Eigen::VectorXd>& target,
                        Eigen::Ref<Eigen::VectorXd> error) const noexcept {
  const Eigen::Matrix3d R = math::rotation_from_wxyz(value.data() + 3);
  const Eigen::Matrix3d R_target = math::rotation_from_wxyz(target.data() + 3);
  error.head<3>() = target.head<3>() - value.head<3>();
  error.tail<3>() = math::log_rotation(R_target * R.transpose());
}

bool PoseFeature::is_valid_target(const double* target, int count) const noexcept {
  return count == 7 && std::isfinite(target[0]) && std::isfinite(target[1]) &&
         std::isfinite(target[2]) && math::is_unit_quaternion(target + 3);
}

}  // namespace palpate::shape
