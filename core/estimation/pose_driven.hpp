#pragma once

#include "core/estimation/hand_follower.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/math/update_result.hpp"

namespace palpate::estimation {

/// Estimator driven by the pose of the hand: the nodes of each closed grasp are held at the pose
/// given by the robot's kinematics; gravity and the contacts other than the wrist's act as loads;
/// the wrench at the wrist is an output. Without body loads the shape of a homogeneous object is
/// then independent of Young's modulus.
class PoseDriven : public Estimator {
 public:
  struct Options {
    HandFollower::Options hand;
    StepWatch::Options step;
  };

  /// Throws std::invalid_argument if an option is not positive.
  explicit PoseDriven(const Options& options) : hands_(options.hand), step_watch_(options.step) {}

  /// Holds every grasp at its rest pose.
  void activate(elasticity::DeformationModel& model) noexcept override;

  /// Degraded while a pose is missing, stale (the last one is held), not finite, or cannot be
  /// reached within a few steps.
  UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                      Estimate& estimate) noexcept override;
  void reset() noexcept override;
  /// Holds every grasp at its pose in the estimate.
  void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept override;

 private:
  HandFollower hands_;
  StepGuard step_guard_;
  StepWatch step_watch_;
};

}  // namespace palpate::estimation
