#include "core/mesh/near_nodes.hpp"

#include <algorithm>
#include <cmath>

#include "core/mesh/connectivity.hpp"

namespace palpate::mesh {

double diagonal(const Eigen::Matrix3Xd& points) {
  Eigen::Vector3d lower = Eigen::Vector3d::Constant(INFINITY), upper = -lower;
  for (int n = 0; n < points.cols(); ++n) {
    if (!points.col(n).allFinite()) continue;
    lower = lower.cwiseMin(points.col(n));
    upper = upper.cwiseMax(points.col(n));
  }
  return (upper.array() >= lower.array()).all() ? (upper - lower).norm() : 0;
}

std::vector<int> near_nodes(const Eigen::Matrix3Xd& points, double tolerance) {
  const int count = static_cast<int>(points.cols());
  // Along a direction that is not normal to grid planes few points have equal coordinates.
  const Eigen::Vector3d line = Eigen::Vector3d(1, std::sqrt(2) - 1, std::sqrt(3) - 1).normalized();
  DisjointSets sets(count);
  std::vector<int> order;
  std::vector<double> place(count);
  for (int n = 0; n < count; ++n) {
    if (!points.col(n).allFinite()) continue;
    place[n] = line.dot(points.col(n));
    order.push_back(n);
  }
  std::sort(order.begin(), order.end(), [&place](int a, int b) {
    return std::make_pair(place[a], a) < std::make_pair(place[b], b);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      if (!(place[order[j]] - place[order[i]] <= tolerance)) break;
      if ((points.col(order[i]) - points.col(order[j])).norm() > tolerance) continue;
      const auto [low, high] = std::minmax({sets.root(order[i]), sets.root(order[j])});
      sets.join(high, low);
      if (points.col(order[i]) == points.col(order[j])) break;  // identical, same neighbours
    }
  }
  std::vector<int> by(count);
  for (int n = 0; n < count; ++n) by[n] = sets.root(n);
  return by;
}

std::vector<int> duplicates(const Eigen::Matrix3Xd& points, double tolerance) {
  const std::vector<int> by = near_nodes(points, tolerance);
  std::vector<int> later;
  for (int n = 0; n < points.cols(); ++n) {
    if (by[n] != n) later.push_back(n);
  }
  return later;
}

}  // namespace palpate::mesh
