#include "sim/camera/point_cloud.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace palpate::camera {
namespace {

using Cell = std::array<int, 3>;

/// The column of each cell's point.
std::vector<Eigen::Index> one_of_each_cell(const Eigen::Matrix3Xd& points, double voxel) {
  std::vector<Cell> cells(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      cells[i][axis] = static_cast<int>(std::floor(points(axis, i) / voxel));
  std::vector<Eigen::Index> order(points.cols());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return cells[a] < cells[b]; });

  std::vector<Eigen::Index> chosen;
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (last = first; last < order.size() && cells[order[last]] == cells[order[first]]; ++last)
      sum += points.col(order[last]);
    const Eigen::Vector3d mean = sum / static_cast<double>(last - first);
    chosen.push_back(*std::min_element(
        order.begin() + first, order.begin() + last, [&](Eigen::Index a, Eigen::Index b) {
          return (points.col(a) - mean).squaredNorm() < (points.col(b) - mean).squaredNorm();
        }));
  }
  return chosen;
}

}  // namespace

Eigen::Matrix3Xd back_project(const DepthImage& depth, const Intrinsics& intrinsics,
                              const Mask& mask) {
  if (!mask.empty() && mask.size() != depth.metres.size())
    throw std::invalid_argument("point cloud: mask and picture differ in size");
  const auto wanted = [&](std::size_t i) {
    return depth.metres[i] > 0 && (mask.empty() || mask[i] != 0);
  };
  Eigen::Index count = 0;
  for (std::size_t i = 0; i < depth.metres.size(); ++i) count += wanted(i);
  Eigen::Matrix3Xd points(3, count);
  Eigen::Index next = 0;
  for (int row = 0; row < depth.height; ++row)
    for (int column = 0; column < depth.width; ++column)
      if (wanted(std::size_t(row) * depth.width + column))
        points.col(next++) = back_project(intrinsics, column, row, depth.at(column, row));
  return points;
}

Eigen::Matrix3Xd thin_by_voxels(const Eigen::Matrix3Xd& points, double voxel, int most) {
  if (!(voxel > 0) || most < 1)
    throw std::invalid_argument("point cloud: needs cubes with a side and room for a point");
  std::vector<Eigen::Index> chosen = one_of_each_cell(points, voxel);
  while (static_cast<int>(chosen.size()) > most) {
    // Points on a surface: their number falls with the square of the side.
    voxel *= std::max(1.1, 0.95 * std::sqrt(chosen.size() / double(most)));
    chosen = one_of_each_cell(points, voxel);
  }
  Eigen::Matrix3Xd thinned(3, chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) thinned.col(i) = points.col(chosen[i]);
  return thinned;
}

}  // namespace palpate::camera
