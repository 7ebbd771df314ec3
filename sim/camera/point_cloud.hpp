#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "sim/camera/depth_camera.hpp"

namespace palpate::camera {

/// Point in C of a pixel with depth `z` (m).
inline Eigen::Vector3d back_project(const draw::Intrinsics& k, double column, double row,
                                    double z) {
  return {z * (column - k.cx) / k.fx, z * (row - k.cy) / k.fy, z};
}

/// Points in C, 3 x n, m, of all pixels that have depth and are in `mask`, row by row; an empty
/// mask selects every pixel. For points in W multiply by X_WC.
Eigen::Matrix3Xd back_project(const draw::DepthImage& depth, const draw::Intrinsics& intrinsics,
                              const Mask& mask = {});

/// Points as a depth camera sees them.
struct ColouredCloud {
  Eigen::Matrix3Xf points;        // m
  std::vector<std::uint8_t> rgb;  // three bytes a point
};

/// Points in C, with their colours, of the pixels that have depth, of every `stride`-th column and
/// row, row by row. Throws std::invalid_argument for a stride below 1.
ColouredCloud coloured_cloud(const DepthFrame& frame, int stride);

/// Thins a cloud with a voxel grid of side `voxel` (m): keeps in each voxel the point nearest to
/// the mean of its points. Points are kept as measured, since the mean of points on a curved
/// surface lies off it. If more than `most` remain, the voxels are enlarged. The order depends only
/// on the points.
Eigen::Matrix3Xd thin_by_voxels(const Eigen::Matrix3Xd& points, double voxel, int most);

}  // namespace palpate::camera
