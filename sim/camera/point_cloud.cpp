#include "sim/camera/point_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace palpate::camera {
namespace {

/// A point with the number of the cell it lies in, which is packed so that sorting is quick.
struct Binned {
  std::uint64_t cell;
  Eigen::Index point;
  bool operator<(const Binned& other) const {
    return cell != other.cell ? cell < other.cell : point < other.point;
  }
};

std::uint64_t cell_of(const Eigen::Vector3d& p, double voxel) {
  constexpr int kBits = 21;
  constexpr std::int64_t kMiddle = std::int64_t{1} << (kBits - 1);  // cells to either side of 0
  std::uint64_t cell = 0;
  for (const double x : p) {
    const auto index = static_cast<std::int64_t>(std::floor(x / voxel));
    cell = cell << kBits | static_cast<std::uint64_t>(
                               std::clamp<std::int64_t>(index + kMiddle, 0, 2 * kMiddle - 1));
  }
  return cell;
}

/// The column of each cell's point.
std::vector<Eigen::Index> one_of_each_cell(const Eigen::Matrix3Xd& points, double voxel) {
  std::vector<Binned> binned(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) binned[i] = {cell_of(points.col(i), voxel), i};
  std::sort(binned.begin(), binned.end());

  std::vector<Eigen::Index> chosen;
  for (auto first = binned.begin(), last = first; first != binned.end(); first = last) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (last = first; last != binned.end() && last->cell == first->cell; ++last)
      sum += points.col(last->point);
    const Eigen::Vector3d mean = sum / static_cast<double>(last - first);
    const auto distance = [&](const Binned& b) {
      return (points.col(b.point) - mean).squaredNorm();
    };
    chosen.push_back(std::min_element(first, last, [&](const Binned& a, const Binned& b) {
                       return distance(a) < distance(b);
                     })->point);
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
