#pragma once

#include <array>

#include "core/estimation/estimator.hpp"
#include "core/math/update_result.hpp"

namespace palpate::estimation {

/// Holds the grasps of a model at the poses given by the robot's kinematics, corrected by the
/// estimated grasp offset and by the deflection of pads of known compliance under the predicted
/// reaction. Releases grasps that the hand releases.
class HandFollower {
 public:
  struct Options {
    double pose_timeout = 0.05;  // s without a new pose until the pose counts as stale
    /// Speed limits at which the held nodes approach a distant pose, as after a start.
    double approach_speed = 1.0;          // m/s
    double approach_angular_speed = 5.0;  // rad/s
    /// Time constant of the pad deflection. It is longer where the pads are softer than the object,
    /// so that model and pads always converge.
    double pad_time = 0.02;  // s
  };

  /// Throws std::invalid_argument if an option is not positive.
  explicit HandFollower(const Options& options);

  /// Holds every grasp at its rest pose; no hand pose is known yet.
  void activate(elasticity::DeformationModel& model) noexcept;
  /// Holds every grasp at its pose in `last`.
  void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept;
  void reset() noexcept { hands_.fill(Hand()); }

  /// Takes the hand's pose and holds or releases the grasp in the model. `correction`, in G: offset
  /// from the kinematic pose of the hand to the pose to be held. `stiffness`: Young's modulus of
  /// the object divided by that of the model, whose reactions are smaller by this factor. Degraded
  /// while the pose is absent, stale or not finite, or the model has not reached it.
  UpdateResult follow(int grasp, const GraspInput& input, double dt,
                      elasticity::DeformationModel& model,
                      const math::Pose& correction = math::Pose::Identity(),
                      double stiffness = 1) noexcept;

  /// Pose at which the model holds the grasp.
  const math::Pose& X_OG(int grasp) const noexcept { return hands_[grasp].held; }

 private:
  struct Hand {
    math::Pose hand = math::Pose::Identity();  // last valid pose of the hand, in O
    math::Pose held = math::Pose::Identity();  // pose at which the model holds the grasp
    double age = 0;                            // s since the last new pose
    /// Deflection of the pads: (m, rad) of the object, in G.
    math::Vector6d deflection = math::Vector6d::Zero();
    bool seen = false;
    bool inherited = false;  // pose taken over from another estimator, whose pad model may differ
  };
  void deflect(Hand& hand, int grasp, double share, const math::Wrench& reaction, double stiffness,
               const elasticity::Body& body) const noexcept;
  double pad_share(int grasp, double dt, double stiffness,
                   const elasticity::DeformationModel& model) const noexcept;
  bool approach(Hand& hand, const math::Pose& goal, double dt) const noexcept;

  Options options_;
  std::array<Hand, 2> hands_;
};

}  // namespace palpate::estimation
