#pragma once

#include <vector>

#include "core/contact/surface_match.hpp"

namespace palpate::control {

/// A ball that the object is to keep away from.
struct Obstacle {
  Eigen::Vector3d center_O = Eigen::Vector3d::Zero();
  double radius = 0.05;  // m
};

/// Where a deformed object is near to obstacles. Nothing allocates after construction.
class ObstacleGaps {
 public:
  /// Of each obstacle: the nearest point of the curved surface, which lies between nodes and comes
  /// nearer than these do, and the nearest nodes, so that what will be nearest next does not come
  /// too fast.
  static constexpr int kPoints = 6;

  struct Point {
    contact::SurfaceMatch on;
    Eigen::Vector3d away_O = Eigen::Vector3d::UnitZ();  // from the obstacle's centre, of length 1
    double gap = 0;                                     // m, from the ball to the point
    double deviation = 0;  // m, of the point's place, the largest of its nodes
  };

  /// `untold`: m, what the deviation of a place is taken to be where none is told.
  ObstacleGaps(const mesh::Surface& surface, std::vector<Obstacle> obstacles, double untold);

  /// Of the object with these positions (3 x n, m). `node_deviation`: m, by node; nullptr: not
  /// told.
  void look(const Eigen::Matrix3Xd& positions, const std::vector<float>* node_deviation) noexcept;

  /// Of the last look: kPoints of each obstacle.
  const std::vector<Point>& points() const noexcept { return points_; }

 private:
  void find_nearest_nodes(const Eigen::Matrix3Xd& positions, const Obstacle& obstacle,
                          Point* points) const noexcept;

  std::vector<Obstacle> obstacles_;
  double untold_;
  std::vector<int> nodes_;  // of the surface
  contact::SurfaceMatcher matcher_;
  std::vector<Point> points_;
};

}  // namespace palpate::control
