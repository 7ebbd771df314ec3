#pragma once

#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/collision/distance_grid.hpp"
#include "core/math/rigid.hpp"

namespace palpate::collision {

/// Shapes, each in its own frame B. Lengths in m.
struct HalfSpace {};  // z <= 0
struct Box {
  Eigen::Vector3d half_size = Eigen::Vector3d::Constant(0.05);  // about the origin
};
struct Sphere {
  double radius = 0.05;  // about the origin
};
struct Cylinder {
  double radius = 0.03;  // about the axis z
  double length = std::numeric_limits<double>::infinity();
};
struct Capsule {
  double radius = 0.03;  // about a segment of the axis z
  double length = 0.1;   // of the segment
};
using Shape =
    std::variant<HalfSpace, Box, Sphere, Cylinder, Capsule, std::shared_ptr<const DistanceGrid>>;

/// Largest number of obstacles.
inline constexpr int kMostObstacles = 8;

/// Where an obstacle is, and how it moves. O: the object's rest frame.
struct Placement {
  math::Pose X_OB = math::Pose::Identity();
  math::Twist V_O_B{};   // of the origin of B, in O
  bool is_known = true;  // false: not placed yet; such an obstacle touches nothing
};

/// Rigid body that a deformable object can touch.
struct Obstacle {
  std::string name;
  Shape shape;
  math::Pose X_OB = math::Pose::Identity();
  double friction = 0.5;  // Coulomb, between obstacle and object, >= 0
  math::Twist V_O_B{};    // of the origin of B, in O
  bool is_known = true;   // as in Placement
  int hand = -1;          // grasp whose hand carries the obstacle rigidly; -1: none
  /// Prior standard deviations of the error of its pose, along and about the axes of B, m and rad.
  /// Zero: the pose is known exactly in this direction.
  math::Vector6d pose_deviation = math::Vector6d::Zero();

  void place(const Placement& placement) noexcept {
    X_OB = placement.X_OB;
    V_O_B = placement.V_O_B;
    is_known = placement.is_known;
  }
  /// Velocity, m/s in O, of the obstacle's material point at `p_O`.
  Eigen::Vector3d velocity_at(const Eigen::Vector3d& p_O) const noexcept {
    return V_O_B.linear + V_O_B.angular.cross(p_O - X_OB.translation());
  }

  /// Throws std::invalid_argument naming the obstacle if a value is out of range.
  void check() const;
};

/// Signed distance, m, of a surface, and its gradient, a unit vector that points out of it.
struct Proximity {
  double distance;
  Eigen::Vector3d normal;
};

/// Proximity, in O, of the obstacle's surface to the point `p_O`: negative inside, exact for all
/// shapes but a DistanceGrid, infinitely far if the obstacle is not placed. Where the nearest
/// surface point is not unique (a centre, an axis) the normal is one of the possible directions.
Proximity proximity(const Obstacle& obstacle, const Eigen::Vector3d& p_O) noexcept;
double distance(const Obstacle& obstacle, const Eigen::Vector3d& p_O) noexcept;
Eigen::Vector3d normal(const Obstacle& obstacle, const Eigen::Vector3d& p_O) noexcept;

/// Radius, m, of a sphere that fits into the shape and touches its surface in the middle of a face,
/// at most kBluntest; 0 for a DistanceGrid, for which it is not known.
double inscribed_radius(const Shape& shape) noexcept;
inline constexpr double kBluntest = 1;  // m

/// Derivative of the normal by the point, 1/m: the Hessian of the distance. It contains the
/// curvature of the surface and is zero on flat ones; undefined at edges. By central differences.
Eigen::Matrix3d normal_derivative(const Obstacle& obstacle, const Eigen::Vector3d& p_O) noexcept;

}  // namespace palpate::collision
