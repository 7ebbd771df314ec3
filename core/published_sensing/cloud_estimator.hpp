#pragma once

#include "core/estimation/hand_follower.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/published_sensing/cloud_matches.hpp"

namespace palpate::published_sensing {

/// What the published methods that follow a camera's cloud (SHAPE_OBSERVATION) have in common in
/// palpated's estimation slot: where the object is clamped is known; the shape stays at rest until
/// the first cloud comes; the hand's pose is used only where `hand` says so, since most of the
/// papers have a camera alone. The cloud is taken as if it were of now: none of them knows its age.
///
/// Some drive the model in the deformation slot by loads. Others have a model of their own and lay
/// their shape over the slot's with carry(); that one is then never stepped and may be any, best
/// `as_rigid_as_possible`, which costs nothing.
class CloudEstimator : public estimation::Estimator {
 public:
  struct Options {
    bool hand = false;  // whether the hand's pose holds its nodes
    estimation::HandFollower::Options follower;
    estimation::StepWatch::Options step;
    double reach = 0.02;  // m, points farther off the surface are of something else
    int points_per_tick = 16;
    double patience = 0.5;  // s without a cloud that are no trouble
  };

  void activate(elasticity::DeformationModel& model) noexcept final;
  /// Degraded while nothing has been seen for `patience`, the model does not converge or, with
  /// `hand`, the hand's pose lacks.
  sensing::UpdateResult update(const estimation::EstimationInputs& inputs,
                               elasticity::DeformationModel& model,
                               estimation::Estimate& estimate) noexcept final;
  void reset() noexcept final;
  void take_over(const estimation::Estimate& last,
                 elasticity::DeformationModel& model) noexcept final;

 protected:
  /// Throws std::invalid_argument where an option is out of range.
  CloudEstimator(const elasticity::Body& body, const mesh::Surface& surface,
                 const Options& options);

  /// Forgets everything; the shape is `positions`, 3 x n.
  virtual void begin(const Eigen::Matrix3Xd& positions) noexcept = 0;
  /// The matches of a new cloud are whole.
  virtual void take(elasticity::DeformationModel& model) noexcept { static_cast<void>(model); }
  /// Each tick once something has been seen.
  virtual elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                         elasticity::DeformationModel& model) noexcept = 0;
  /// After each tick, what is known beside the shape.
  virtual void tell(estimation::Estimate& estimate) noexcept { static_cast<void>(estimate); }

  const CloudMatches& matches() const noexcept { return matches_; }
  bool uses_hand() const noexcept { return options_.hand; }
  /// With `hand`: where the pose of `grasp` puts one of its nodes, m, in O.
  Eigen::Vector3d held_place(int grasp, int node, const elasticity::Body& body) const noexcept;
  /// Lays a shape over the model's. Allocates nothing.
  elasticity::StepReport carry(const Eigen::Matrix3Xd& shape,
                               elasticity::DeformationModel& model) noexcept;

 private:
  Options options_;
  CloudMatches matches_;
  estimation::HandFollower follower_;
  estimation::StepGuard step_guard_;
  estimation::StepWatch step_watch_;
  Eigen::Matrix3Xd rest_, still_;
  bool seen_ = false;
  double unseen_for_ = 0;  // s
};

/// Springs and dampers of all matches of a cloud together, shared alike, onto the nodes of their
/// places: added to `loads`, N. `stiffness` in N/m, `damping` in N s/m.
void pull_to_cloud(const CloudMatches& matches, double stiffness, double damping,
                   const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities,
                   Eigen::Matrix3Xd& loads) noexcept;

}  // namespace palpate::published_sensing
