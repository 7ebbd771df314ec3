#pragma once

#include <array>

#include "core/estimation/estimator.hpp"

namespace palpate::estimation {

/// Holds the grasps of a model at the poses that the robot's kinematics give, corrected by what an
/// estimator knows better and by how pads of known compliance give way under what the model says
/// that the hand bears; lets go what the hand lets go.
class HandFollower {
 public:
  struct Options {
    double pose_timeout = 0.05;  // s without a new pose until it counts as stale
    /// The held nodes approach a far pose, as at the start, no faster than this.
    double approach_speed = 1.0;          // m/s
    double approach_angular_speed = 5.0;  // rad/s
    /// In which pads are taken to give way; slower where they are softer than the object, so that
    /// model and pads always come to rest.
    double pad_time = 0.02;  // s
  };

  /// Throws std::invalid_argument where an option is not positive.
  explicit HandFollower(const Options& options);

  /// Holds every grasp at its rest pose; no pose of a hand is known.
  void activate(elasticity::DeformationModel& model) noexcept;
  /// Holds every grasp where `last` has it.
  void take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept;
  void reset() noexcept { hands_.fill(Hand()); }

  /// Takes the hand's pose and lets the model hold or release the grasp. `correction`, in G: from
  /// where the kinematics say the hand is to where it is held to be. `stiffness`: of the object
  /// over that of the model, whose reactions are smaller by it. Returns what is wrong, or "".
  const char* follow(int grasp, const GraspInput& input, double dt,
                     elasticity::DeformationModel& model,
                     const math::Pose& correction = math::Pose::Identity(),
                     double stiffness = 1) noexcept;

  /// Where the model holds the grasp.
  const math::Pose& X_OG(int grasp) const noexcept { return hands_[grasp].held; }

 private:
  struct Hand {
    math::Pose hand = math::Pose::Identity();      // last good pose of the hand, in O
    math::Pose held = math::Pose::Identity();      // where the model holds the grasp
    double age = 0;                                // s since a new pose came
    math::Vector6d give = math::Vector6d::Zero();  // of the pads: (m, rad) of the object, in G
    bool seen = false;
    bool inherited = false;  // held where another estimator had it, which may give way otherwise
  };
  void give_way(Hand& hand, int grasp, double share, const math::Wrench& reaction, double stiffness,
                const elasticity::Body& body) const noexcept;
  double pad_share(int grasp, double dt, double stiffness,
                   const elasticity::DeformationModel& model) const noexcept;
  bool approach(Hand& hand, const math::Pose& goal, double dt) const noexcept;

  Options options_;
  std::array<Hand, 2> hands_;
};

}  // namespace palpate::estimation
