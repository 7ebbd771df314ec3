#pragma once

#include <vector>

#include "core/collision/box_tree.hpp"
#include "core/collision/obstacle.hpp"
#include "core/collision/surface_samples.hpp"
#include "core/contact/surface_match.hpp"

namespace palpate::control {

/// Distances between the deformed object and obstacles of any shape. Nothing allocates after
/// construction.
class ObstacleGaps {
 public:
  /// Points per obstacle: the nearest point of the curved surface, which lies between nodes and is
  /// nearer than they are, and the nearest nodes, so that the next nearest point does not approach
  /// too fast.
  static constexpr int kPoints = 6;

  struct Point {
    contact::SurfaceMatch on;
    Eigen::Vector3d away_O = Eigen::Vector3d::UnitZ();  // unit vector out of the obstacle
    /// m, signed, from the surface of the obstacle to the point
    double gap = 0;
    /// m, standard deviation of the point's position, the largest of its nodes
    double deviation = 0;
  };

  /// `fallback_deviation`: m, standard deviation of positions when none is estimated.
  ObstacleGaps(const mesh::ElementMesh& mesh, std::vector<collision::Obstacle> obstacles,
               double fallback_deviation);

  void place(int obstacle, const collision::Placement& placement) noexcept {
    obstacles_[obstacle].place(placement);
  }
  const collision::Obstacle& obstacle(int index) const noexcept { return obstacles_[index]; }

  /// Evaluates the object with these positions (3 x n, m). `node_deviation`: m, by node; nullptr:
  /// not estimated.
  void look(const Eigen::Matrix3Xd& positions, const std::vector<float>* node_deviation) noexcept;

  /// Result of the last look(): kPoints per obstacle, with an infinite gap if it is not placed.
  const std::vector<Point>& points() const noexcept { return points_; }

 private:
  contact::SurfaceMatch find_nearest_samples(const Eigen::Matrix3Xd& positions,
                                             const collision::Obstacle& obstacle,
                                             Point* points) const noexcept;
  contact::SurfaceMatch approach(const collision::Obstacle& obstacle,
                                 const contact::SurfaceMatch& from) const noexcept;

  std::vector<collision::Obstacle> obstacles_;
  double fallback_deviation_;
  std::vector<mesh::PointWeights> samples_;  // of the surface, its nodes among them
  collision::BoxTree tree_;
  contact::SurfaceMatcher matcher_;
  std::vector<Point> points_;
};

}  // namespace palpate::control
