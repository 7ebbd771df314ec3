#pragma once

#include "core/estimation/hand_follower.hpp"
#include "core/estimation/step_watch.hpp"

namespace palpate::estimation {

/// The hand's pose drives the mesh: the nodes of each holding grasp are held at the pose that the
/// robot's kinematics give, gravity and the contacts other than the wrist's load it, and the wrench
/// at the wrist is an output. Without body loads the shape of a homogeneous object does not depend
/// on Young's modulus at all then.
class PoseDriven : public Estimator {
 public:
  struct Options {
    HandFollower::Options hand;
    StepWatch::Options step;
  };

  /// Throws std::invalid_argument where an option is not positive.
  explicit PoseDriven(const Options& options) : hands_(options.hand), step_watch_(options.step) {}

  /// Holds every grasp at its rest pose.
  void activate(elasticity::DeformationModel& model) noexcept override;

  /// Degraded while a pose is missing, stale (the last one holds), not finite, or not to be reached
  /// within some steps.
  sensing::UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                               Estimate& estimate) noexcept override;
  void reset() noexcept override;
  /// Holds every grasp where the estimate has it.
  void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept override;

 private:
  HandFollower hands_;
  StepGuard step_guard_;
  StepWatch step_watch_;
};

}  // namespace palpate::estimation
