#pragma once

#include "core/control/twist_law.hpp"

namespace palpate::control {

/// Proportional law u = J^+ (gain * error). Supports every feature; with an exact J each component
/// of the error decays as exp(-gain t).
class ProportionalTwist : public TwistLaw {
 public:
  explicit ProportionalTwist(const Options& options) : TwistLaw(options) {}

 protected:
  void motion_to_target(const LawInputs& inputs, Eigen::VectorXd& motion) noexcept override {
    motion = *inputs.error;
  }
};

}  // namespace palpate::control
