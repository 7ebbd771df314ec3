#pragma once

#include <algorithm>
#include <cmath>

#include "core/mesh/surface.hpp"

namespace palpate::support {

/// Least value(point) over many points of each face of the curved surface, `parts` to an edge: an
/// upper bound of the minimum.
template <class Value>
double least_on_surface(const mesh::Surface& surface, const Eigen::Matrix3Xd& x, const Value& value,
                        int parts = 16) {
  double least = 1e300;
  for (const std::vector<int>& nodes : surface.triangle_nodes) {
    for (int i = 0; i <= parts; ++i) {
      for (int j = 0; i + j <= parts; ++j) {
        const double b = static_cast<double>(i) / parts, c = static_cast<double>(j) / parts;
        const double a = 1 - b - c;
        Eigen::Vector3d q = a * x.col(nodes[0]) + b * x.col(nodes[1]) + c * x.col(nodes[2]);
        if (nodes.size() == 6)
          q = a * (2 * a - 1) * x.col(nodes[0]) + b * (2 * b - 1) * x.col(nodes[1]) +
              c * (2 * c - 1) * x.col(nodes[2]) + 4 * a * b * x.col(nodes[3]) +
              4 * b * c * x.col(nodes[4]) + 4 * c * a * x.col(nodes[5]);
        least = std::min(least, value(q));
      }
    }
  }
  return least;
}

/// From `p` to the curved surface: an upper bound.
inline double distance_to_surface(const mesh::Surface& surface, const Eigen::Matrix3Xd& x,
                                  const Eigen::Vector3d& p) {
  return least_on_surface(surface, x, [&](const Eigen::Vector3d& q) { return (q - p).norm(); });
}

}  // namespace palpate::support
