#include "tools/lab/baselines/control/two_camera_view.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <stdexcept>

namespace palpate::baselines {
namespace {

constexpr double kNearest = 0.05;  // m, minimum depth of a projected point

/// Camera at `eye` with its z axis towards `target`.
math::Pose camera_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d aside = z.cross(Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d x = (aside.norm() > 1e-6 ? aside : Eigen::Vector3d::UnitX()).normalized();
  Eigen::Matrix3d R_OC;
  R_OC << x, z.cross(x), z;
  return math::make_pose(R_OC, eye).inverse();
}

}  // namespace

TwoCameraView::TwoCameraView(const Options& options) : options_(options) {
  if (!(options.focal > 0)) throw std::invalid_argument("the focal length must be positive");
  for (int c = 0; c < 2; ++c) {
    if (!((options.eyes_O[c] - options.target_O).norm() > kNearest))
      throw std::invalid_argument("a camera stands in what it looks at");
    X_CO_[c] = camera_at(options.eyes_O[c], options.target_O);
  }
}

void TwoCameraView::resize(const shape::Feature& feature) {
  check_points(feature);
  points_ = static_cast<int>(feature.rest_points().size());
  if (feature.dimension() != 3 * points_)
    throw std::invalid_argument("two cameras see all components of a point");
  by_point_.assign(points_, Eigen::Matrix<double, 4, 3>::Zero());
}

void TwoCameraView::measure(const Eigen::VectorXd& value, Eigen::VectorXd& seen) noexcept {
  for (int p = 0; p < points_; ++p) {
    for (int c = 0; c < 2; ++c) {
      const Eigen::Vector3d q = X_CO_[c] * Eigen::Vector3d(value.segment<3>(3 * p));
      const double depth = std::max(kNearest, q.z());
      seen.segment<2>(4 * p + 2 * c) = options_.focal * q.head<2>() / depth;
      Eigen::Matrix<double, 2, 3> pinhole;
      pinhole << 1, 0, -q.x() / depth, 0, 1, -q.y() / depth;
      by_point_[p].middleRows<2>(2 * c) = options_.focal / depth * pinhole * X_CO_[c].linear();
    }
  }
}

void TwoCameraView::express(const Eigen::MatrixXd& J_seen, Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  for (int p = 0; p < points_; ++p) {
    const Eigen::Matrix<double, 4, 3>& M = by_point_[p];
    const Eigen::Matrix3d normal = M.transpose() * M;
    const Eigen::Matrix<double, 3, 4> inverse = normal.inverse() * M.transpose();
    J.middleRows<3>(3 * p).noalias() = inverse.lazyProduct(J_seen.middleRows<4>(4 * p));
  }
}

}  // namespace palpate::baselines
