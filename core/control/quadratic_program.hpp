#pragma once

#include "core/control/motion_limits.hpp"
#include "core/control/proportional_twist.hpp"

namespace palpate::control {

/// The motion that brings the feature to its target as the proportional law does, as far as limits
/// allow: min |J u - gain e|^2 + damping |u|^2 + smoothness |u - u_before|^2 under MotionLimits.
/// Where no limit is active it is the damped least-squares motion. Without a solution it brakes.
///
/// With limits of joints it solves for their velocities, u = J_arm dq/dt, and uses whatever freedom
/// the feature leaves them. Where a limit presses, the part of the error that remains with every
/// place still within its limit (to first order) is added to what is unreachable.
class QuadraticProgramLaw : public ProportionalTwist {
 public:
  struct Limited {
    MotionLimitOptions limits;
    double smoothness = 0;  // share of the mean squared singular value of J
    std::vector<int> grasps{0};
    const elasticity::Body* body = nullptr;  // for limits of stress and stretch
  };

  /// Throws std::invalid_argument where an option is out of range.
  QuadraticProgramLaw(const Options& options, const Limited& limited);

  void configure_for(const shape::Feature& feature) override;
  void reset() noexcept override;

  const math::QuadraticProgramSolver& solver() const noexcept { return solver_; }
  const MotionLimits& limits() const noexcept { return limits_; }

 protected:
  PseudoInverse::Motion solve(const LawInputs& inputs, const Eigen::VectorXd& motion,
                              LawOutput& output) noexcept override;
  void rest() noexcept override;

 private:
  bool commands_joints() const noexcept { return !limited_.limits.joints.empty(); }
  bool set_map(const LawInputs& inputs) noexcept;
  void set_objective(const Eigen::VectorXd& motion) noexcept;
  const char* remark(const LawInputs& inputs) noexcept;
  void add_unreachable(const LawInputs& inputs, LawOutput& output) noexcept;

  Limited limited_;
  MotionLimits limits_;
  math::QuadraticProgram program_, reach_;
  math::QuadraticProgramSolver solver_, reach_solver_;
  MotionLimits::Map map_;              // motion by variables
  MotionLimits::Variables variables_;  // of the tick before
  PseudoInverse::Motion before_;       // the motion that they made
  Eigen::MatrixXd J_;                  // feature, scaled, by variables
  Eigen::VectorXd motion_;             // scaled
};

}  // namespace palpate::control
