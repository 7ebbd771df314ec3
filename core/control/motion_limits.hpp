#pragma once

#include <vector>

#include "core/control/control_law.hpp"
#include "core/math/quadratic_program.hpp"

namespace palpate::control {

/// A ball that the object is to keep away from.
struct Obstacle {
  Eigen::Vector3d center_O = Eigen::Vector3d::Zero();
  double radius = 0.05;  // m
};

/// How a pinch holds: two fingers press along `normal_G` with `pinch` each and slip where the force
/// across, with the torque about the normal over `lever`, exceeds what friction bears.
struct SlipCone {
  double pinch = 0;  // N; 0: it cannot slip
  double friction = 0.5;
  double lever = 0.02;  // m, of friction against turning about the normal
  Eigen::Vector3d normal_G = Eigen::Vector3d::UnitY();
};

struct MotionLimitOptions {
  double linear_speed = 1.0;          // m/s
  double angular_speed = 0.5;         // rad/s
  double linear_acceleration = 0.5;   // m/s^2
  double angular_acceleration = 2.0;  // rad/s^2
  double force = 1e3;                 // N, of each component of a grasp's wrench
  double torque = 1e3;                // N m
  SlipCone slip;
  Eigen::Vector3d workspace_lower{-1e3, -1e3, -1e3};  // m, of the origin of G, in O
  Eigen::Vector3d workspace_upper{1e3, 1e3, 1e3};
  std::vector<Obstacle> obstacles;  // at most kMostObstacles
  double clearance = 0.005;         // m, kept from obstacles
  /// A limit is approached no faster than by this share of what is left, 1/s, so that it is not
  /// passed between two looks at it (a velocity damper: Faverjon and Tournassoud 1987).
  double damper = 5;
  /// The object nears buckling where the smallest pivot of its stiffness falls below this share of
  /// the first one seen; motion fades to rest at a quarter of it.
  double pivot = 0.2;
};

/// The rows of a quadratic program over the motion of one or two grasps that keep these limits:
/// u = (v, w) of each in O, m/s and rad/s. Hard: speed and acceleration. Giving way, the last one
/// first: wrench and slip (level 1), obstacles (level 2), workspace of the hand (level 3).
/// Reference: control.md 6.6. Nothing allocates after construction.
class MotionLimits {
 public:
  static constexpr int kMostObstacles = 4;
  static constexpr int kNodesPerObstacle = 6;  // the nearest of the surface
  using Motion = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 12, 1>;

  /// `grasps`: which of the body's move, one or two. Throws std::invalid_argument where an option
  /// is out of range.
  MotionLimits(const MotionLimitOptions& options, std::vector<int> grasps);

  /// Adds the rows to `program`, whose variables are the motion divided by `scale`. `before`: the
  /// motion of the tick before. Always the same number of rows.
  void add_to(math::QuadraticProgram& program, const LawInputs& inputs, const Motion& before,
              const Motion& scale) noexcept;

  /// 1 far from buckling, 0 at it.
  double ease(const elasticity::DeformationModel& model) noexcept;
  void reset() noexcept { first_pivot_ = 0; }

 private:
  using Row = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 12>;
  void add_speed(math::QuadraticProgram& program, const LawInputs& inputs, const Motion& before,
                 const Motion& scale, double ease) noexcept;
  void add_wrench(math::QuadraticProgram& program, const LawInputs& inputs, const Motion& scale,
                  int moving) noexcept;
  void add_obstacle(math::QuadraticProgram& program, const elasticity::DeformationModel& model,
                    const Motion& scale, const Obstacle& obstacle) noexcept;
  int size() const noexcept { return 6 * static_cast<int>(grasps_.size()); }

  MotionLimitOptions options_;
  std::vector<int> grasps_;
  double first_pivot_ = 0;
};

}  // namespace palpate::control
