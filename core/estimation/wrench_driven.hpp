#pragma once

#include "core/estimation/estimator.hpp"
#include "core/estimation/step_watch.hpp"

namespace palpate::estimation {

/// E1: the whole measured wrench of the hand, force and torque, drives the mesh. The grasp stays
/// the rigid patch that it is and is moved, xi, until its reaction w is the wrench that the hand
/// measures. Each update makes a part of a damped Newton step,
///   d xi = (1 - e^(-dt / T)) K_w^T (K_w K_w^T + s^2)^-1 (w_measured - w),
/// with the stiffness of the grasp K_w = dw / dxi that the model has anyway, so that the difference
/// decays in a time T in all directions alike, however differently stiff they are (a soft bar: some
/// 200 N/m along, 0.2 N/m across). Directions softer than s follow slower, as (K_w / s)^2: there
/// the sensor's noise would move the grasp far. Both wrenches of two hands are met at once.
///
/// The same wrench as dead loads on a free patch (ForceDriven behind a wrench patch) bends the
/// patch, and runs away from equilibria which only the hand's stiffness keeps, as of a bar that is
/// buckled: there K_w is not definite, but Newton's method does not ask for that.
///
/// A wrench has many poses that answer it. The one is found that is near where the grasp has been:
/// what the hand feels is followed from then on, and a wrench that jumps far may lead elsewhere.
///
/// Gravity and the contacts other than the wrist's load the mesh. Needs a quasi-static model with a
/// sensitivity. Reference: control.md 6.2, 6.3.
class WrenchDriven : public Estimator {
 public:
  struct Options {
    double time_constant = 0.1;     // s, T
    double average = 0.03;          // s, time constant of the measured wrench's filter
    double least_stiffness = 0.02;  // N/m, s
    double wrench_timeout = 0.05;   // s without a new wrench until it counts as stale
    /// The grasp moves no faster than this, whatever the wrench says.
    double speed = 1.0;          // m/s
    double angular_speed = 5.0;  // rad/s
    StepWatch::Options step;
  };

  /// Throws std::invalid_argument where an option is not positive, or where nothing fixes the body:
  /// a wrench does not tell where a free one is.
  WrenchDriven(const elasticity::Body& body, const Options& options);

  /// Holds every grasp at its rest pose.
  void activate(elasticity::DeformationModel& model) noexcept override;

  /// Degraded while a wrench is missing, stale or not finite, or there is no sensitivity: the grasp
  /// stays where it is; also where the wrench is not met after some time. A fault where the model
  /// moves by inertia, whose wrench is no stiffness'. estimate.X_OG: where the wrenches put the
  /// grasps.
  sensing::UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                               Estimate& estimate) noexcept override;
  void reset() noexcept override;
  /// Goes on from where the estimate has the grasps.
  void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept override;

 private:
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 12>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 12, 1>;
  struct Hand {
    math::Pose held = math::Pose::Identity();          // where the model holds the grasp
    math::Vector6d wrench = math::Vector6d::Zero();    // measured, filtered
    math::Vector6d reaction = math::Vector6d::Zero();  // of the model in the last step
    double age = 0;                                    // s since a wrench came
    bool seen = false;                                 // a wrench
    bool answered = false;                             // the model has stepped with it held
  };

  const char* take(int grasp, const GraspInput& input, double dt,
                   elasticity::DeformationModel& model) noexcept;
  void move(const elasticity::Sensitivity& sensitivity, double dt) noexcept;

  Options options_;
  double length_;  // m, by which rotations and torques compare with displacements and forces
  std::array<Hand, 2> hands_;
  std::array<bool, 2> follows_{};  // in this update
  double far_for_ = 0;             // s that the wrenches have not been met
  StepGuard step_guard_;
  StepWatch step_watch_;
};

}  // namespace palpate::estimation
