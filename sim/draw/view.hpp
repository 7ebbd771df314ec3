#pragma once

#include "core/math/rigid.hpp"

namespace palpate::draw {

/// Pinhole model: a point (x, y, z) in the camera frame projects to column fx x / z + cx, row fy y
/// / z + cy. Integers are pixel centres, (0, 0) is the upper left pixel.
struct Intrinsics {
  double fx = 0;  // px
  double fy = 0;
  double cx = 0;
  double cy = 0;

  /// Square pixels, optical axis through the image centre. `vertical` field of view in radians.
  static Intrinsics from_field_of_view(double vertical, int width, int height);
};

/// Camera pose. Camera frame C: x right, y down, z forward.
struct View {
  math::Pose X_WC = math::Pose::Identity();
  Intrinsics intrinsics;
  double near = 0.05;  // m, near clipping distance
  double far = 20;     // m, far clipping distance
};

/// Pose X_WC of a camera at `eye` that looks at `target`, its image top towards `up`. All in W.
/// Throws std::invalid_argument if the three do not define a pose.
math::Pose look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                   const Eigen::Vector3d& up);

/// View from `eye` towards `target`. `vertical_field_of_view` in radians.
View make_view(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Eigen::Vector3d& up,
               double vertical_field_of_view, int width, int height);

}  // namespace palpate::draw
