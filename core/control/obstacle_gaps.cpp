#include "core/control/obstacle_gaps.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace palpate::control {
namespace {

constexpr int kSteps = 3;     // on a curved face: accurate to a micrometre
constexpr int kSearches = 4;  // of the nearest point, for shapes other than spheres

std::vector<Eigen::AlignedBox3d> points_as_boxes(std::size_t count) {
  return std::vector<Eigen::AlignedBox3d>(count, Eigen::AlignedBox3d(Eigen::Vector3d::Zero()));
}

}  // namespace

ObstacleGaps::ObstacleGaps(const mesh::Surface& surface, std::vector<collision::Obstacle> obstacles,
                           double fallback_deviation)
    : obstacles_(std::move(obstacles)),
      fallback_deviation_(fallback_deviation),
      nodes_(surface.nodes),
      tree_(points_as_boxes(nodes_.size())),
      matcher_(surface, kSteps),
      points_(kPoints * obstacles_.size()) {}

void ObstacleGaps::look(const Eigen::Matrix3Xd& positions,
                        const std::vector<float>* node_deviation) noexcept {
  matcher_.take(positions);
  tree_.refit(
      [&](int i) { return Eigen::AlignedBox3d(Eigen::Vector3d(positions.col(nodes_[i]))); });
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const collision::Obstacle& obstacle = obstacles_[o];
    Point* const points = points_.data() + kPoints * o;
    find_nearest_nodes(positions, obstacle, points + 1);
    points[0].on = find_nearest_point(obstacle, points[1]);
    for (int i = 0; i < kPoints; ++i) {
      Point& point = points[i];
      point.away_O = collision::normal(obstacle, point.on.position);
      point.gap = collision::distance(obstacle, point.on.position);
      point.deviation = node_deviation == nullptr ? fallback_deviation_ : 0;
      for (int k = 0; node_deviation != nullptr && k < point.on.count; ++k)
        point.deviation = std::max<double>(
            point.deviation, (*node_deviation)[static_cast<std::size_t>(point.on.nodes[k])]);
    }
  }
}

/// Starts from the nearest node. The surface point nearest to the centre of a sphere that touches
/// the obstacle from inside, at its point nearest to the last one, comes nearer to the obstacle
/// until it is nearest to both.
contact::SurfaceMatch ObstacleGaps::find_nearest_point(const collision::Obstacle& obstacle,
                                                       const Point& nearest_node) const noexcept {
  contact::SurfaceMatch best = nearest_node.on;
  double gap = collision::distance(obstacle, best.position);
  if (!obstacle.is_known) return best;
  const double radius = collision::inscribed_radius(obstacle.shape);
  for (int search = 0; search < kSearches; ++search) {
    const Eigen::Vector3d center =
        best.position - (gap + radius) * collision::normal(obstacle, best.position);
    const contact::SurfaceMatch next = matcher_.find(center);
    const double next_gap = collision::distance(obstacle, next.position);
    if (next.count == 0 || !(next_gap < gap)) break;
    best = next;
    gap = next_gap;
  }
  return best;
}

/// Nearest first; a surface with fewer nodes repeats its last one.
void ObstacleGaps::find_nearest_nodes(const Eigen::Matrix3Xd& positions,
                                      const collision::Obstacle& obstacle,
                                      Point* points) const noexcept {
  std::array<int, kPoints - 1> nearest;
  std::array<double, kPoints - 1> gaps;
  nearest.fill(nodes_.back());
  gaps.fill(std::numeric_limits<double>::infinity());
  tree_.visit(
      [&](const Eigen::AlignedBox3d& box) {
        const double reach = gaps.back() + 0.5 * box.diagonal().norm();
        return collision::distance(obstacle, box.center()) < reach;
      },
      [&](int i) {
        int node = nodes_[i];
        double gap = collision::distance(obstacle, positions.col(node));
        for (std::size_t k = 0; k < nearest.size(); ++k) {
          if (gap > gaps[k] || (gap == gaps[k] && node > nearest[k])) continue;
          std::swap(gap, gaps[k]);
          std::swap(node, nearest[k]);
        }
      });
  for (std::size_t k = 0; k < nearest.size(); ++k) {
    contact::SurfaceMatch& on = points[k].on;
    on.count = 1;
    on.nodes[0] = nearest[k];
    on.weights[0] = 1;
    on.position = positions.col(nearest[k]);
  }
}

}  // namespace palpate::control
