#pragma once

#include "core/estimation/estimator.hpp"
#include "core/estimation/step_watch.hpp"

namespace palpate::estimation {

/// The hand's pose drives the mesh: the nodes of each holding grasp are held at the pose that the
/// robot's kinematics give, gravity and the contacts other than the wrist's load it, and the wrench
/// at the wrist is an output. Without body loads the shape of a homogeneous object does not depend
/// on Young's modulus at all then.
class PoseDriven : public Estimator {
 public:
  struct Options {
    double pose_timeout = 0.05;  // s without a new pose until it counts as stale
    /// The held nodes approach a far pose, as at the start, no faster than this.
    double approach_speed = 1.0;          // m/s
    double approach_angular_speed = 5.0;  // rad/s
    StepWatch::Options step;
  };

  /// Throws std::invalid_argument where an option is not positive.
  explicit PoseDriven(const Options& options);

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
  struct Hand {
    math::Pose hand = math::Pose::Identity();  // last good pose of the hand, in O
    math::Pose held = math::Pose::Identity();  // where the model holds the grasp
    double age = 0;                            // s since a new pose came
    bool seen = false;
  };

  const char* follow(int grasp, const GraspInput& input, double dt,
                     elasticity::DeformationModel& model) noexcept;
  bool approach(Hand& hand, double dt) const noexcept;

  Options options_;
  std::array<Hand, 2> hands_;
  StepGuard step_guard_;
  StepWatch step_watch_;
};

}  // namespace palpate::estimation
