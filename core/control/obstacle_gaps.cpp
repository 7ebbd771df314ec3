#include "core/control/obstacle_gaps.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace palpate::control {
namespace {

constexpr int kSteps = 3;     // on a curved face: accurate to a micrometre
constexpr int kSearches = 6;  // of the nearest point

/// So close that the nearest of the samples lies in the region of the nearest point.
double spacing_for(const std::vector<collision::Obstacle>& obstacles) {
  double spacing = std::numeric_limits<double>::infinity();
  for (const collision::Obstacle& obstacle : obstacles)
    spacing = std::min(spacing, collision::sample_spacing(obstacle));
  return spacing;
}

std::vector<Eigen::AlignedBox3d> boxes_of(const std::vector<mesh::PointWeights>& samples,
                                          const Eigen::Matrix3Xd& positions) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const mesh::PointWeights& sample : samples)
    boxes.emplace_back(sample.interpolate(positions));
  return boxes;
}

contact::SurfaceMatch on_sample(const mesh::PointWeights& sample,
                                const Eigen::Matrix3Xd& positions) noexcept {
  contact::SurfaceMatch on;
  on.count = sample.count;
  std::copy_n(sample.nodes.begin(), sample.count, on.nodes.begin());
  std::copy_n(sample.weights.begin(), sample.count, on.weights.begin());
  on.position = sample.interpolate(positions);
  return on;
}

}  // namespace

ObstacleGaps::ObstacleGaps(const mesh::ElementMesh& mesh,
                           std::vector<collision::Obstacle> obstacles, double fallback_deviation)
    : obstacles_(std::move(obstacles)),
      fallback_deviation_(fallback_deviation),
      samples_(collision::surface_samples(mesh::extract_surface(mesh), mesh.nodes,
                                          spacing_for(obstacles_))),
      tree_(boxes_of(samples_, mesh.nodes)),
      matcher_(mesh::extract_surface(mesh), kSteps),
      points_(kPoints * obstacles_.size()) {}

void ObstacleGaps::look(const Eigen::Matrix3Xd& positions,
                        const std::vector<float>* node_deviation) noexcept {
  matcher_.take(positions);
  tree_.refit([&](int i) { return Eigen::AlignedBox3d(samples_[i].interpolate(positions)); });
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const collision::Obstacle& obstacle = obstacles_[o];
    Point* const points = points_.data() + kPoints * o;
    points[0].on = approach(obstacle, find_nearest_samples(positions, obstacle, points + 1));
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

/// The surface point nearest to the obstacle, from one nearby. The surface point nearest to the
/// centre of a sphere that touches the obstacle from inside, at its point nearest to the last one,
/// comes nearer to the obstacle until it is nearest to both; at edges, where no sphere touches from
/// inside, the one nearest to that point itself.
contact::SurfaceMatch ObstacleGaps::approach(const collision::Obstacle& obstacle,
                                             const contact::SurfaceMatch& from) const noexcept {
  if (!obstacle.is_known) return from;
  contact::SurfaceMatch best = from;
  double gap = collision::distance(obstacle, best.position);
  double radius = collision::inscribed_radius(obstacle.shape);
  for (int search = 0; search < kSearches; ++search) {
    const Eigen::Vector3d center =
        best.position - (gap + radius) * collision::normal(obstacle, best.position);
    const contact::SurfaceMatch next = matcher_.find(center);
    const double next_gap = collision::distance(obstacle, next.position);
    if (next.count > 0 && next_gap < gap) {
      best = next;
      gap = next_gap;
    } else if (radius > 0) {
      radius = 0;
    } else {
      break;
    }
  }
  return best;
}

/// Sets `points` to the nearest nodes, nearest first; returns the nearest sample. An obstacle that
/// is not placed gets any nodes.
contact::SurfaceMatch ObstacleGaps::find_nearest_samples(const Eigen::Matrix3Xd& positions,
                                                         const collision::Obstacle& obstacle,
                                                         Point* points) const noexcept {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<int, kPoints - 1> nodes;  // as samples
  std::array<double, kPoints - 1> gaps;
  nodes.fill(0);
  gaps.fill(kInfinity);
  int nearest = 0;
  double least = kInfinity;
  tree_.visit(
      [&](const Eigen::AlignedBox3d& box) {
        const double reach = gaps.back() + 0.5 * box.diagonal().norm();
        return collision::distance(obstacle, box.center()) < reach;
      },
      [&](int i) {
        const Eigen::Vector3d position = samples_[i].interpolate(positions);
        double gap = collision::distance(obstacle, position);
        if (gap < least) {
          least = gap;
          nearest = i;
        }
        if (samples_[i].count != 1) return;
        for (std::size_t k = 0; k < nodes.size(); ++k) {
          if (gap > gaps[k] || (gap == gaps[k] && i > nodes[k])) continue;
          std::swap(gap, gaps[k]);
          std::swap(i, nodes[k]);
        }
      });
  for (std::size_t k = 0; k < nodes.size(); ++k)
    points[k].on = on_sample(samples_[nodes[k]], positions);
  return on_sample(samples_[nearest], positions);
}

}  // namespace palpate::control
