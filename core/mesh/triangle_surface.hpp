#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::mesh {

/// Triangles of a surface as read from a file, including faults: an invalid index is -1,
/// coordinates may be non-finite.
struct TriangleSurface {
  Eigen::Matrix3Xd points;  // m
  /// Indices of points, outward by the right-hand rule if oriented correctly.
  Eigen::Matrix3Xi triangles;
  std::vector<long> numbers = {};  // numbers of the triangles in their file, from 1

  int point_count() const { return static_cast<int>(points.cols()); }
  int triangle_count() const { return static_cast<int>(triangles.cols()); }
  long number(int t) const { return numbers.empty() ? t : numbers[t]; }
};

/// Volume within a closed surface, m^3; negative if it is oriented inward.
double enclosed_volume(const TriangleSurface& surface);

}  // namespace palpate::mesh
