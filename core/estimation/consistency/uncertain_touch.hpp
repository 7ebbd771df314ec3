#pragma once

#include <array>
#include <utility>
#include <vector>

#include "core/elasticity/deformation_model.hpp"

namespace palpate::estimation {

/// Wrenches by contact with obstacles whose pose is less certain than they are pressed in. The sum
/// F of the normal forces on an obstacle is never negative: by a displacement d of the obstacle it
/// is max(0, F + c d), so that the derivative c at the present shape overestimates what a wrench
/// says of d where the contact may be open. Statistical linearisation (Gelb 1974, section 6.2)
/// replaces it, for normally distributed d, by the mean of the force, its regression on d and the
/// remaining variance. Nothing allocates after construction.
class UncertainTouch {
 public:
  using Directions = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0,
                                   collision::kMostFreeDirections, collision::kMostFreeDirections>;

  explicit UncertainTouch(std::vector<collision::FreeDirection> directions)
      : directions_(std::move(directions)) {}

  /// The wrench of a hand, N and N m, as a function of the displacement of obstacles.
  struct Wrench {
    elasticity::Sensitivity::ObstacleWrenches by_direction;  // derivative
    math::Vector6d excess;      // mean, minus the wrench at the present shape
    math::Matrix6d covariance;  // of what is not linear in the displacement
  };

  /// Takes the forces of the model's contacts. `stiffness`: Young's modulus divided by the model's.
  void take(const elasticity::DeformationModel& model, double stiffness) noexcept;
  /// `by_direction`: derivative of the hand's wrench at the present shape. `known`: covariance of
  /// the displacements.
  Wrench linearise(const elasticity::Sensitivity::ObstacleWrenches& by_direction,
                   const Directions& known) const noexcept;

 private:
  std::vector<collision::FreeDirection> directions_;
  std::array<double, collision::kMostObstacles> force_{};                  // N, normal, by obstacle
  decltype(elasticity::Sensitivity::dcontact_dobstacle) by_displacement_;  // N/m, N/rad
};

}  // namespace palpate::estimation
