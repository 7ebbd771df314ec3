#pragma once

#include "core/estimation/estimator.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/math/update_result.hpp"

namespace palpate::estimation {

/// Estimator E1: the full measured wrench of the hand, force and torque, drives the mesh. The grasp
/// remains a rigid patch; its pose xi is moved until its reaction w equals the measured wrench.
/// Each update performs a fraction of a damped Newton step, d xi = (1 - e^(-dt / T)) K_w^T (K_w
/// K_w^T + s^2)^-1 (w_measured - w), with the grasp stiffness K_w = dw / dxi, which the model
/// provides. The difference therefore decays with the time constant T in all directions, however
/// different their stiffnesses (a soft bar: about 200 N/m axially, 0.2 N/m transversely).
/// Directions softer than s converge more slowly, as (K_w / s)^2, because sensor noise would
/// otherwise move the grasp far. The wrenches of two hands are matched simultaneously.
///
/// Applying the same wrench as dead loads on a free patch (ForceDriven with a wrench patch) deforms
/// the patch and diverges at equilibria that are stabilised only by the stiffness of the hand, such
/// as those of a buckled bar. There K_w is indefinite, which Newton's method tolerates.
///
/// Several poses may produce the same wrench. The estimator finds the one near the previous pose of
/// the grasp and follows the wrench from there; a large jump of the wrench may lead to a different
/// solution.
///
/// Gravity and the contacts other than the wrist's act as loads. Requires a quasi-static model with
/// a sensitivity. Reference: docs/theory.md, sections 2 and 3.
class WrenchDriven : public Estimator {
 public:
  struct Options {
    double time_constant = 0.1;     // s, T
    double average = 0.03;          // s, time constant of the filter of the measured wrench
    double least_stiffness = 0.02;  // N/m, the damping s above
    double wrench_timeout = 0.05;   // s without a new wrench until the wrench counts as stale
    /// Speed limits of the grasp, whatever the wrench.
    double speed = 1.0;          // m/s
    double angular_speed = 5.0;  // rad/s
    StepWatch::Options step;
  };

  /// Throws std::invalid_argument if an option is not positive, or if no part of the body is fixed:
  /// a wrench does not determine the position of a free body.
  WrenchDriven(const elasticity::Body& body, const Options& options);

  /// Holds every grasp at its rest pose.
  void activate(elasticity::DeformationModel& model) noexcept override;

  /// Degraded while a wrench is missing, stale or not finite, or no sensitivity is available; the
  /// grasp then stays in place. Also degraded if the wrench is not matched for some time. Fault if
  /// the model is dynamic, because its wrench contains inertial forces. estimate.X_OG: grasp poses
  /// determined from the wrenches.
  UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                      Estimate& estimate) noexcept override;
  void reset() noexcept override;
  /// Continues from the grasp poses of the estimate.
  void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept override;

 private:
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 12>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 12, 1>;
  struct Hand {
    math::Pose held = math::Pose::Identity();          // pose at which the model holds the grasp
    math::Vector6d wrench = math::Vector6d::Zero();    // measured, filtered
    math::Vector6d reaction = math::Vector6d::Zero();  // reaction of the model in the last step
    double age = 0;                                    // s since the last wrench
    bool seen = false;                                 // a wrench has been received
    bool answered = false;                             // the model has stepped with this grasp held
  };

  UpdateResult take(int grasp, const GraspInput& input, double dt,
                    elasticity::DeformationModel& model) noexcept;
  void move(const elasticity::Sensitivity& sensitivity, double dt) noexcept;

  Options options_;
  /// m, length that makes rotations and torques comparable with displacements and forces
  double length_;
  std::array<Hand, 2> hands_;
  std::array<bool, 2> follows_{};  // grasps moved in this update
  double far_for_ = 0;             // s for which the wrenches have not been matched
  StepGuard step_guard_;
  StepWatch step_watch_;
};

}  // namespace palpate::estimation
