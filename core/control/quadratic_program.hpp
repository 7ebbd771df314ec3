#pragma once

#include "core/control/motion_limits.hpp"
#include "core/control/twist_law.hpp"

namespace palpate::control {

/// Motion that brings the feature to its target like the proportional law, subject to limits: min
/// |J u - gain e|^2 + damping |u|^2 + smoothness |u - u_before|^2 under MotionLimits. Without
/// active limits this is the damped least-squares motion. If the program has no solution, the
/// motion is braked.
///
/// With joint limits the program solves for joint velocities, u = J_arm dq/dt, and uses the
/// redundancy of the arm. If limits are active, the error that remains at the best position within
/// all limits (to first order) is added to the unreachable part.
class QuadraticProgramLaw : public ProportionalTwist {
 public:
  struct Limited {
    MotionLimitOptions limits;
    double smoothness = 0;  // relative to the mean squared singular value of J
    std::vector<int> grasps{0};
    const elasticity::Body* body = nullptr;  // required for limits of stress and stretch
  };

  /// Throws std::invalid_argument if an option is out of range.
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
  MotionLimits::Map map_;              // maps variables to motion
  MotionLimits::Variables variables_;  // variables of the previous tick
  PseudoInverse::Motion before_;       // motion of the previous tick
  /// Scaled Jacobian of the feature with respect to the variables.
  Eigen::MatrixXd J_;
  Eigen::VectorXd motion_;  // scaled
};

}  // namespace palpate::control
