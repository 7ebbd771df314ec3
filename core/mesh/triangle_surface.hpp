#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::mesh {

/// Triangles as a file of a surface holds them, faults and all: an index that was no node is -1,
/// coordinates may not be finite.
struct TriangleSurface {
  Eigen::Matrix3Xd points;     // m
  Eigen::Matrix3Xi triangles;  // columns of points, outward by the right-hand rule if all is well
  std::vector<long> numbers = {};  // of the triangles in their file, from 1

  int point_count() const { return static_cast<int>(points.cols()); }
  int triangle_count() const { return static_cast<int>(triangles.cols()); }
  long number(int t) const { return numbers.empty() ? t : numbers[t]; }
};

/// Volume within a closed surface, m^3; negative where it is inside out.
double enclosed_volume(const TriangleSurface& surface);

}  // namespace palpate::mesh
