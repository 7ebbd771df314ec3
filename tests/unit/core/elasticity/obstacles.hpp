#pragma once

#include <gtest/gtest.h>

#include "tests/unit/core/elasticity/stepping.hpp"

namespace palpate::elasticity {

inline constexpr double kGravity = 9.81;  // m/s^2

/// A plane through `point` whose normal is `normal`.
inline collision::Obstacle plane(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                 double friction) {
  const Eigen::Matrix3d R =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix();
  return {"plane", collision::HalfSpace{}, math::make_pose(R, point), friction};
}

/// A cylinder along y.
inline collision::Obstacle rod(const Eigen::Vector3d& centre, double radius, double friction) {
  return {"rod", collision::Cylinder{radius},
          math::make_pose(rotation(M_PI / 2, Eigen::Vector3d::UnitX()), centre), friction};
}

inline SolverOptions with_obstacles(std::vector<collision::Obstacle> obstacles) {
  SolverOptions options;
  options.contact.obstacles = std::move(obstacles);
  return options;
}

inline Eigen::Vector3d contact_force(const CorotationalModel& model) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SurfaceContact& contact : model.contacts()) sum += contact.force;
  return sum;
}

/// Largest penetration of a contact point, m.
inline double deepest(const CorotationalModel& model) {
  double depth = 0;
  for (const SurfaceContact& contact : model.contacts()) depth = std::max(depth, -contact.gap);
  return depth;
}

/// Steps with a new factor every `period` steps.
inline void run_steps(CorotationalModel& model, int steps, int period = 20) {
  for (int i = 0; i < steps; ++i) {
    ASSERT_NE(model.step(kDt).status, StepStatus::kFailed) << "step " << i;
    if (i % period == 0) refactor(model);
  }
}

}  // namespace palpate::elasticity
