#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::shapes {

/// Camera without distortion: x_cam = rotation * p + translation, axes right, down, forward (as
/// OpenCV's).
struct PinholeCamera {
  Eigen::Vector2d focal{1, 1}, centre{0, 0};  // pixels
  int width = 0, height = 0;                  // pixels
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  // m

  Eigen::Vector3d in_camera(const Eigen::Vector3d& p) const { return rotation * p + translation; }
  /// Pixels.
  Eigen::Vector2d project(const Eigen::Vector3d& p) const;
  /// Where the ray through p meets the plane of constant z, m.
  Eigen::Vector3d onto_plane(const Eigen::Vector3d& p, double z) const;
  /// Angle between the optical axis and the z axis, rad, from 0 to pi / 2.
  double obliquity() const;
};

/// Distance of a point from a line of segments (columns); infinite if it has fewer than two points.
double distance_to_line(const Eigen::Vector2d& point, const Eigen::Matrix2Xd& line);

/// Border of the picture of a closed surface.
struct SurfaceOutline {
  Eigen::Matrix2Xd whole;    // pixels, of the entire surface
  Eigen::Matrix2Xd without;  // pixels, of the part that is seen of the unmarked triangles
};

/// Renders triangles (columns of corner indices; `marked`: one flag each) with a depth buffer. The
/// outlines are the centres of covered pixels next to uncovered ones. Triangles must lie in front
/// of the camera.
SurfaceOutline surface_outline(const PinholeCamera& camera, const Eigen::Matrix3Xd& positions,
                               const Eigen::Matrix3Xi& triangles, const std::vector<bool>& marked);

}  // namespace palpate::shapes
