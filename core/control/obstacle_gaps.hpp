#pragma once

#include <vector>

#include "core/contact/surface_match.hpp"

namespace palpate::control {

/// Spherical obstacle that the object must not touch.
struct Obstacle {
  Eigen::Vector3d center_O = Eigen::Vector3d::Zero();
  double radius = 0.05;  // m
};

/// Distances between the deformed object and obstacles. Nothing allocates after construction.
class ObstacleGaps {
 public:
  /// Points per obstacle: the nearest point of the curved surface, which lies between nodes and is
  /// nearer than they are, and the nearest nodes, so that the next nearest point does not approach
  /// too fast.
  static constexpr int kPoints = 6;

  struct Point {
    contact::SurfaceMatch on;
    Eigen::Vector3d away_O = Eigen::Vector3d::UnitZ();  // unit vector from the obstacle's centre
    /// m, from the surface of the obstacle to the point
    double gap = 0;
    /// m, standard deviation of the point's position, the largest of its nodes
    double deviation = 0;
  };

  /// `fallback_deviation`: m, standard deviation of positions when none is estimated.
  ObstacleGaps(const mesh::Surface& surface, std::vector<Obstacle> obstacles,
               double fallback_deviation);

  /// Evaluates the object with these positions (3 x n, m). `node_deviation`: m, by node; nullptr:
  /// not estimated.
  void look(const Eigen::Matrix3Xd& positions, const std::vector<float>* node_deviation) noexcept;

  /// Result of the last look(): kPoints per obstacle.
  const std::vector<Point>& points() const noexcept { return points_; }

 private:
  void find_nearest_nodes(const Eigen::Matrix3Xd& positions, const Obstacle& obstacle,
                          Point* points) const noexcept;

  std::vector<Obstacle> obstacles_;
  double fallback_deviation_;
  std::vector<int> nodes_;  // nodes of the surface
  contact::SurfaceMatcher matcher_;
  std::vector<Point> points_;
};

}  // namespace palpate::control
