#pragma once

#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "core/elasticity/deformation_model.hpp"

namespace palpate::estimation {

/// Wrenches by contact with obstacles whose pose is less certain than they are pressed in. The sum
/// F of the normal forces on an obstacle is never negative: by a displacement d of the obstacle it
/// is max(0, F + c d), so that the derivative c at the present shape overestimates what a wrench
/// says of d where the contact may be open. Statistical linearisation (Gelb 1974, section 6.2)
/// replaces it, for normally distributed d, by the mean of the force, its regression on d and the
/// remaining variance. An obstacle that the model does not touch yet, but that may be touched in
/// truth, adds an unknown force at the nearest point, along its normal, of up to several times that
/// of the hand. Nothing allocates after construction.
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

  /// Takes the model's contacts. `stiffness`: Young's modulus divided by the model's.
  void take(const elasticity::DeformationModel& model, double stiffness) noexcept;
  /// Of hand `grasp`. `by_direction`: derivative of its wrench at the present shape. `known`:
  /// covariance of the displacements. `force`: N, size of its force.
  Wrench linearise(int grasp, const elasticity::Sensitivity::ObstacleWrenches& by_direction,
                   const Directions& known, double force) const noexcept;

 private:
  /// Point of the object next to an obstacle that the model does not touch.
  struct Nearest {
    double gap = std::numeric_limits<double>::infinity();  // m
    Eigen::Vector3d position = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    /// Of a hand's wrench by the force along the normal: minus the motion of the point by the hand
    /// (Maxwell and Betti).
    std::array<math::Vector6d, 2> by_force{math::Vector6d::Zero(), math::Vector6d::Zero()};
  };
  static void find_response(const elasticity::DeformationModel& model, Nearest& nearest) noexcept;
  static math::Matrix6d possible_contact(int grasp, const Nearest& nearest, double variance,
                                         double force) noexcept;

  std::vector<collision::FreeDirection> directions_;
  std::array<double, collision::kMostObstacles> force_{};  // N, normal, by obstacle
  std::array<Nearest, collision::kMostObstacles> nearest_;
  decltype(elasticity::Sensitivity::dcontact_dobstacle) by_displacement_;  // N/m, N/rad
};

}  // namespace palpate::estimation
