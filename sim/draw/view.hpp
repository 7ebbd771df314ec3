#pragma once

#include "core/math/rigid.hpp"

namespace palpate::draw {

/// Pinhole: a point (x, y, z) of the camera frame is seen at column fx x / z + cx, row
/// fy y / z + cy. Whole numbers are centres of pixels, (0, 0) that of the upper left one.
struct Intrinsics {
  double fx = 0;  // px
  double fy = 0;
  double cx = 0;
  double cy = 0;

  /// Square pixels, optical axis through the middle. `vertical` in radians.
  static Intrinsics from_field_of_view(double vertical, int width, int height);
};

/// Where a camera stands. Camera frame C: x right, y down, z forward.
struct View {
  math::Pose X_WC = math::Pose::Identity();
  Intrinsics intrinsics;
  double near = 0.05;  // m, nothing nearer is drawn
  double far = 20;     // m, nor farther
};

/// Pose X_WC of a camera at `eye` that looks at `target`, its top towards `up`. All in W. Throws
/// std::invalid_argument where the three do not define a pose.
math::Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                   const Eigen::Vector3d& up);

/// View from `eye` towards `target`. `vertical_field_of_view` in radians.
View make_view(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up,
               double vertical_field_of_view, int width, int height);

}  // namespace palpate::draw
