#pragma once

#include "core/control/twist_law.hpp"

namespace palpate::control {

/// Pose control with dual quaternions (Ozgur and Mezouar 2016). The feature's twist is -gain times
/// the screw of x_c (x) x_d*, so that it approaches its target along one screw while angle and
/// distance decay as exp(-gain t). Supports pose features.
class DualQuaternion : public TwistLaw {
 public:
  explicit DualQuaternion(const Options& options) : TwistLaw(options) {}

  void configure_for(const shape::Feature& feature) override;

 protected:
  void motion_to_target(const LawInputs& inputs, Eigen::VectorXd& motion) noexcept override;
};

}  // namespace palpate::control
