#pragma once

#include "core/estimation/consistency/learning_guard.hpp"
#include "core/estimation/contact_tracker.hpp"
#include "core/estimation/hand_follower.hpp"
#include "core/estimation/node_deviations.hpp"
#include "core/estimation/observation_update.hpp"
#include "core/estimation/rest_detector.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/math/update_result.hpp"

namespace palpate::estimation {

/// Estimator E3: the pose of the hand drives the mesh; a Kalman filter uses the wrench at the wrist
/// to estimate Young's modulus, the offset of the grasp, the bias of the sensor and, if these do
/// not explain the wrench, an unmodelled external contact (docs/theory.md, section 4). The
/// covariances weigh pose against wrench in each direction: the pose prevails where its deviation
/// is below that of the wrench divided by the stiffness of the grasp. Shape, deviations of the
/// shape and predicted wrench follow.
///
/// An external contact is searched for only while the hands rest, in the change of the wrenches
/// since the hands came to rest, because the errors of the model itself, which vary with the hand's
/// pose, are then constant. It is dropped when a hand moves.
///
/// Estimator E4: observed surface points, whenever available, correct the same states and also
/// virtual loads, which absorb errors of the model's shape, so that a continuously observed shape
/// is tracked without steady-state error (docs/theory.md, section 5). Loads rather than an offset
/// of the feature keep shape, features and their Jacobian consistent with one mechanical state, and
/// the correction remains valid when observations stop. The wrench prediction excludes the virtual
/// loads. Corrections from observations are faded into the shape, which therefore never jumps.
///
/// Young's modulus changes without a new factorisation: an object k times as stiff has the shape of
/// the nominal one under 1 / k of its weight and loads, and k times its wrenches.
class PoseWrenchFilter : public Estimator {
 public:
  /// Options of its parts, whose headers describe them.
  struct Options : WrenchUpdate::Options,
                   RestDetector::Options,
                   ContactTracker::Options,
                   ObservationUpdate::Options {
    HandFollower::Options hand;
    StepWatch::Options step;
    WrenchFilter::Options filter;
    LearningGuard::Options consistency;
    NodeDeviations::Options deviations;
  };

  /// Throws std::invalid_argument if an option is out of range.
  PoseWrenchFilter(const elasticity::Body& body, const mesh::Surface& surface,
                   const Options& options);

  void activate(elasticity::DeformationModel& model) noexcept override;
  /// Degraded under the conditions of the pose-driven estimator, and while the wrench cannot be
  /// explained. Without a wrench the pose alone determines the shape.
  UpdateResult update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                      Estimate& estimate) noexcept override;
  void reset() noexcept override;
  void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept override;

  const WrenchFilter& filter() const noexcept { return state_.filter; }
  const WrenchConsistency& consistency() const noexcept { return guard_.test(); }

 private:
  UpdateResult set_boundary(const EstimationInputs& inputs, int grasps, double dt,
                            elasticity::DeformationModel& model) noexcept;
  void predict(const EstimationInputs& inputs, int grasps, double dt,
               const elasticity::DeformationModel& model) noexcept;
  void update_wrench(const elasticity::DeformationModel& model, bool follows) noexcept;
  void write_estimate(const elasticity::DeformationModel& model, int grasps,
                      Estimate& estimate) noexcept;

  HandFollower follower_;
  StepGuard step_guard_;
  StepWatch step_watch_;
  FusedState state_;
  double period_;  // s, between two wrench updates
  WrenchUpdate wrenches_;
  LearningGuard guard_;
  RestDetector rest_;
  ContactTracker contact_;
  ObservationUpdate observations_;
  NodeDeviations node_deviations_;
};

}  // namespace palpate::estimation
