#pragma once

#include <Eigen/Core>

#include "sim/camera/depth_camera.hpp"

namespace palpate::camera {

/// Point in C that a pixel with depth `z` (m) shows.
inline Eigen::Vector3d back_project(const draw::Intrinsics& k, double column, double row,
                                    double z) {
  return {z * (column - k.cx) / k.fx, z * (row - k.cy) / k.fy, z};
}

/// Points in C, 3 x n, m, of all pixels that have depth and are in `mask`, row by row; an empty
/// mask means every pixel. For points in W multiply by X_WC.
Eigen::Matrix3Xd back_project(const draw::DepthImage& depth, const draw::Intrinsics& intrinsics,
                              const Mask& mask = {});

/// Thins a cloud by a grid of cubes of side `voxel` (m): of each cube the point that is nearest to
/// the mean of the points in it. Points are kept as they were measured, since the mean of points on
/// a curved surface lies beside it. Where more than `most` are left, the cubes grow. The
/// order depends on the points alone.
Eigen::Matrix3Xd thin_by_voxels(const Eigen::Matrix3Xd& points, double voxel, int most);

}  // namespace palpate::camera
