#include "core/control/obstacle_gaps.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace palpate::control {
namespace {

constexpr int kSteps = 3;  // on a curved face: accurate to a micrometre

}  // namespace

ObstacleGaps::ObstacleGaps(const mesh::Surface& surface, std::vector<Obstacle> obstacles,
                           double fallback_deviation)
    : obstacles_(std::move(obstacles)),
      fallback_deviation_(fallback_deviation),
      nodes_(surface.nodes),
      matcher_(surface, kSteps),
      points_(kPoints * obstacles_.size()) {}

void ObstacleGaps::look(const Eigen::Matrix3Xd& positions,
                        const std::vector<float>* node_deviation) noexcept {
  matcher_.take(positions);
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const Obstacle& obstacle = obstacles_[o];
    Point* const points = points_.data() + kPoints * o;
    points[0].on = matcher_.find(obstacle.center_O);
    find_nearest_nodes(positions, obstacle, points + 1);
    for (int i = 0; i < kPoints; ++i) {
      Point& point = points[i];
      const Eigen::Vector3d way = point.on.position - obstacle.center_O;
      const double from_center = way.norm();
      point.away_O =
          from_center > 1e-9 ? Eigen::Vector3d(way / from_center) : Eigen::Vector3d::UnitZ();
      point.gap = from_center - obstacle.radius;
      point.deviation = node_deviation == nullptr ? fallback_deviation_ : 0;
      for (int k = 0; node_deviation != nullptr && k < point.on.count; ++k)
        point.deviation = std::max<double>(
            point.deviation, (*node_deviation)[static_cast<std::size_t>(point.on.nodes[k])]);
    }
  }
}

/// Nearest first; a surface with fewer nodes repeats its last one.
void ObstacleGaps::find_nearest_nodes(const Eigen::Matrix3Xd& positions, const Obstacle& obstacle,
                                      Point* points) const noexcept {
  std::array<int, kPoints - 1> nearest;
  std::array<double, kPoints - 1> squared;
  nearest.fill(nodes_.back());
  squared.fill(std::numeric_limits<double>::infinity());
  for (int node : nodes_) {
    double d = (positions.col(node) - obstacle.center_O).squaredNorm();
    for (std::size_t k = 0; k < nearest.size(); ++k) {
      if (d >= squared[k]) continue;
      std::swap(d, squared[k]);
      std::swap(node, nearest[k]);
    }
  }
  for (std::size_t k = 0; k < nearest.size(); ++k) {
    contact::SurfaceMatch& on = points[k].on;
    on.count = 1;
    on.nodes[0] = nearest[k];
    on.weights[0] = 1;
    on.position = positions.col(nearest[k]);
  }
}

}  // namespace palpate::control
