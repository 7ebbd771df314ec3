#include "sim/camera/point_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

namespace palpate::camera {
namespace {

/// Points first <= i < last share a cell. The cell's index is packed into one integer; sorting a
/// few runs of many points is fast.
struct Run {
  std::uint64_t cell;
  Eigen::Index first, last;
  bool operator<(const Run& other) const {
    return cell != other.cell ? cell < other.cell : first < other.first;
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

std::vector<Run> sorted_runs(const Eigen::Matrix3Xd& points, double voxel) {
  std::vector<Run> runs;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const std::uint64_t cell = cell_of(points.col(i), voxel);
    if (runs.empty() || runs.back().cell != cell) runs.push_back({cell, i, i});
    runs.back().last = i + 1;
  }
  std::sort(runs.begin(), runs.end());
  return runs;
}

/// The column of each cell's point.
std::vector<Eigen::Index> one_of_each_cell(const Eigen::Matrix3Xd& points, double voxel) {
  const std::vector<Run> runs = sorted_runs(points, voxel);
  std::vector<Eigen::Index> chosen;
  for (std::size_t first = 0, last = 0; first < runs.size(); first = last) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Index count = 0;
    for (last = first; last < runs.size() && runs[last].cell == runs[first].cell; ++last) {
      for (Eigen::Index i = runs[last].first; i < runs[last].last; ++i, ++count)
        sum += points.col(i);
    }
    const Eigen::Vector3d mean = sum / static_cast<double>(count);
    Eigen::Index nearest = runs[first].first;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t run = first; run < last; ++run) {
      for (Eigen::Index i = runs[run].first; i < runs[run].last; ++i) {
        const double distance = (points.col(i) - mean).squaredNorm();
        if (!(distance < least)) continue;
        least = distance;
        nearest = i;
      }
    }
    chosen.push_back(nearest);
  }
  return chosen;
}

}  // namespace

Eigen::Matrix3Xd back_project(const draw::DepthImage& depth, const draw::Intrinsics& intrinsics,
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

ColouredCloud coloured_cloud(const DepthFrame& frame, int stride) {
  if (stride < 1) throw std::invalid_argument("point cloud: needs a stride of a pixel or more");
  const draw::DepthImage& depth = frame.depth;
  std::vector<Eigen::Vector2i> pixels;
  for (int row = 0; row < depth.height; row += stride)
    for (int column = 0; column < depth.width; column += stride)
      if (depth.at(column, row) > 0) pixels.emplace_back(column, row);
  ColouredCloud cloud{Eigen::Matrix3Xf(3, pixels.size()), {}};
  cloud.rgb.reserve(3 * pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int column = pixels[i].x(), row = pixels[i].y();
    cloud.points.col(static_cast<Eigen::Index>(i)) =
        back_project(frame.view.intrinsics, column, row, depth.at(column, row)).cast<float>();
    const std::uint8_t* rgb = frame.colour.pixel(column, row);
    cloud.rgb.insert(cloud.rgb.end(), rgb, rgb + 3);
  }
  return cloud;
}

Eigen::Matrix3Xd thin_by_voxels(const Eigen::Matrix3Xd& points, double voxel, int most) {
  if (!(voxel > 0) || most < 1)
    throw std::invalid_argument("point cloud: needs cubes with a side and room for a point");
  std::vector<Eigen::Index> chosen = one_of_each_cell(points, voxel);
  while (static_cast<int>(chosen.size()) > most) {
    // Points on a surface: their number scales with the inverse square of the voxel side.
    voxel *= std::max(1.1, 0.95 * std::sqrt(chosen.size() / double(most)));
    chosen = one_of_each_cell(points, voxel);
  }
  Eigen::Matrix3Xd thinned(3, chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) thinned.col(i) = points.col(chosen[i]);
  return thinned;
}

}  // namespace palpate::camera
