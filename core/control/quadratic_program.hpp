#pragma once

#include "core/control/motion_limits.hpp"
#include "core/control/proportional_twist.hpp"

namespace palpate::control {

/// The motion that brings the feature to its target as the proportional law does, as far as limits
/// allow: min |J u - gain e|^2 + damping |u|^2 + smoothness |u - u_before|^2 under MotionLimits.
/// Where no limit is active it is the damped least-squares motion. Without a solution it brakes.
class QuadraticProgramLaw : public ProportionalTwist {
 public:
  struct Limited {
    MotionLimitOptions limits;
    double smoothness = 0;  // share of the mean squared singular value of J
    std::vector<int> grasps{0};
  };

  /// Throws std::invalid_argument where an option is out of range.
  QuadraticProgramLaw(const Options& options, const Limited& limited);

  void configure_for(const shape::Feature& feature) override;
  void reset() noexcept override;

  const math::QuadraticProgramSolver& solver() const noexcept { return solver_; }

 protected:
  PseudoInverse::Motion solve(const LawInputs& inputs, const Eigen::VectorXd& motion,
                              LawOutput& output) noexcept override;
  void rest() noexcept override { before_.setZero(); }

 private:
  double smoothness_;
  MotionLimits limits_;
  math::QuadraticProgram program_;
  math::QuadraticProgramSolver solver_;
  PseudoInverse::Motion scale_, before_;
  Eigen::MatrixXd J_;       // scaled rows and columns
  Eigen::VectorXd motion_;  // scaled
};

}  // namespace palpate::control
