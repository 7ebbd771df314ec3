#pragma once

#include "core/control/twist_law.hpp"

namespace palpate::control {

/// The screw that leads from one pose to another: angle theta about and distance d along the line
/// with direction l and moment m = p x l.
struct Screw {
  double angle = 0;     // rad, in [0, pi]
  double distance = 0;  // m
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // m

  /// theta (m, l) + d (l, 0): displacement of the point at the origin of O, rotation.
  math::Twist twist() const noexcept {
    return {angle * moment + distance * direction, angle * direction};
  }
};

/// Screw of the dual quaternion x_c (x) x_d*, i.e. of X_c X_d^-1, in O. Poses as p, then w, x, y, z.
Screw screw_between(const Eigen::VectorXd& current, const Eigen::VectorXd& desired) noexcept;

/// Pose control with dual quaternions (Ozgur and Mezouar 2016): the feature's twist is -gain times
/// the screw of x_c (x) x_d*, so that it comes to its target along one screw and its angle and
/// distance die away as exp(-gain t). Steers pose features.
class DualQuaternion : public TwistLaw {
 public:
  explicit DualQuaternion(const Options& options) : TwistLaw(options) {}

  void configure_for(const shape::Feature& feature) override;

 protected:
  void motion_to_target(const LawInputs& inputs, Eigen::VectorXd& motion) noexcept override;
};

}  // namespace palpate::control
