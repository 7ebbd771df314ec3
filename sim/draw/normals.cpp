#include "sim/draw/normals.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

namespace palpate::draw {

Eigen::Matrix3Xd corner_normals(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xi& triangles,
                                double crease) {
  const Eigen::Index count = triangles.cols();
  Eigen::Matrix3Xd areas(3, count);  // normal times twice the area
  std::vector<std::vector<Eigen::Index>> around(points.cols());
  for (Eigen::Index t = 0; t < count; ++t) {
    const Eigen::Vector3d a = points.col(triangles(0, t));
    const Eigen::Vector3d b = points.col(triangles(1, t));
    const Eigen::Vector3d c = points.col(triangles(2, t));
    areas.col(t) = (b - a).cross(c - a);
    for (int i = 0; i < 3; ++i) around[triangles(i, t)].push_back(t);
  }
  const Eigen::Matrix3Xd units = areas.colwise().normalized();

  const double least_cosine = std::cos(crease);
  Eigen::Matrix3Xd normals(3, 3 * count);
  for (Eigen::Index t = 0; t < count; ++t) {
    for (int i = 0; i < 3; ++i) {
      Eigen::Vector3d sum = areas.col(t);
      for (const Eigen::Index other : around[triangles(i, t)]) {
        if (other != t && units.col(t).dot(units.col(other)) > least_cosine)
          sum += areas.col(other);
      }
      normals.col(3 * t + i) = sum.normalized();
    }
  }
  return normals;
}

}  // namespace palpate::draw
