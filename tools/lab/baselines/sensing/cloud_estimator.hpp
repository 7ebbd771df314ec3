#pragma once

#include "core/estimation/hand_follower.hpp"
#include "core/estimation/step_watch.hpp"
#include "core/math/update_result.hpp"
#include "tools/lab/baselines/sensing/cloud_matches.hpp"

namespace palpate::baselines {

/// Base of the baselines that track a camera's point cloud (SHAPE_OBSERVATION) in the estimation
/// slot of palpated: the clamped nodes are known; the shape remains at rest until the first cloud
/// arrives; the pose of the hand is used only with `hand`, because most of the papers use a camera
/// only. The cloud is taken as current, because none of the methods knows its latency.
///
/// Some methods load the model in the deformation slot. Others have a model of their own and copy
/// their shape to the slot's with carry(); that model is then never stepped and may be any,
/// preferably `as_rigid_as_possible`, which has no cost.
class CloudEstimator : public estimation::Estimator {
 public:
  struct Options {
    bool hand = false;  // whether the grasped nodes are held at the pose of the hand
    estimation::HandFollower::Options follower;
    estimation::StepWatch::Options step;
    double reach = 0.02;  // m, points farther from the surface belong to other objects
    int points_per_tick = 16;
    double patience = 0.5;  // s without a cloud that are tolerated
  };

  void activate(elasticity::DeformationModel& model) noexcept final;
  /// Degraded while no cloud has arrived for `patience`, the model does not converge or, with
  /// `hand`, the pose of the hand is missing.
  UpdateResult update(const estimation::EstimationInputs& inputs,
                      elasticity::DeformationModel& model,
                      estimation::Estimate& estimate) noexcept final;
  void reset() noexcept final;
  void take_over(const estimation::Estimate& last,
                 elasticity::DeformationModel& model) noexcept final;

 protected:
  /// Throws std::invalid_argument if an option is out of range.
  CloudEstimator(const elasticity::Body& body, const mesh::Surface& surface,
                 const Options& options);

  /// Resets the state; the shape is `positions`, 3 x n.
  virtual void begin(const Eigen::Matrix3Xd& positions) noexcept = 0;
  /// Called when the matches of a new cloud are complete.
  virtual void take(elasticity::DeformationModel& model) noexcept { static_cast<void>(model); }
  /// Called in each tick after the first cloud.
  virtual elasticity::StepReport advance(double dt, const estimation::EstimationInputs& inputs,
                                         elasticity::DeformationModel& model) noexcept = 0;
  /// Called after each tick; writes estimates other than the shape.
  virtual void report(estimation::Estimate& estimate) noexcept { static_cast<void>(estimate); }

  const CloudMatches& matches() const noexcept { return matches_; }
  bool uses_hand() const noexcept { return options_.hand; }
  /// With `hand`: position of a node of `grasp` given by the pose of the hand, m, in O.
  Eigen::Vector3d held_place(int grasp, int node, const elasticity::Body& body) const noexcept;
  /// Sets the model's shape. Does not allocate.
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

/// Adds the nodal forces, N, of equal springs and dampers on all matches of a cloud to `loads`.
/// `stiffness`: their total, N/m; `damping`: N s/m.
void pull_to_cloud(const CloudMatches& matches, double stiffness, double damping,
                   const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities,
                   Eigen::Matrix3Xd& loads) noexcept;

}  // namespace palpate::baselines
