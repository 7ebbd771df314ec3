#include "sim/draw/view.hpp"

#include <cmath>
#include <stdexcept>

namespace palpate::draw {

Intrinsics Intrinsics::from_field_of_view(double vertical, int width, int height) {
  const double focal = 0.5 * height / std::tan(0.5 * vertical);
  return {focal, focal, 0.5 * (width - 1), 0.5 * (height - 1)};
}

math::Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                   const Eigen::Vector3d& up) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  if (!(std::abs(right.norm() - 1) < 1e-6)) {
    throw std::invalid_argument("camera: eye, target and up must not lie on one line");
  }
  math::Pose X_WC = math::Pose::Identity();
  X_WC.linear() << right, forward.cross(right), forward;
  X_WC.translation() = eye;
  return X_WC;
}

View make_view(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up,
               double vertical_field_of_view, int width, int height) {
  View view;
  view.X_WC = look_at(eye, target, up);
  view.intrinsics = Intrinsics::from_field_of_view(vertical_field_of_view, width, height);
  return view;
}

}  // namespace palpate::draw
