#include "core/estimation/hand_follower.hpp"

#include <stdexcept>

#include "core/elasticity/grasp_pose.hpp"

namespace palpate::estimation {

HandFollower::HandFollower(const Options& options) : options_(options) {
  if (!(options.pose_timeout > 0) || !(options.approach_speed > 0) ||
      !(options.approach_angular_speed > 0)) {
    throw std::invalid_argument("timeout and speeds of a pose-driven estimator must be positive");
  }
}

void HandFollower::activate(elasticity::DeformationModel& model) noexcept {
  reset();
  const elasticity::Body& body = model.body();
  for (int i = 0; i < static_cast<int>(body.grasps.size()); ++i) {
    hands_[i].hand = hands_[i].held = body.grasps[i].X_OG_rest;
    model.hold(i, hands_[i].held);
  }
}

void HandFollower::take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept {
  activate(model);
  for (int i = 0; i < static_cast<int>(model.body().grasps.size()); ++i) {
    if (!last.X_OG[i].matrix().allFinite()) continue;
    hands_[i].hand = hands_[i].held = last.X_OG[i];
    hands_[i].seen = true;
    model.hold(i, hands_[i].held);
  }
}

const char* HandFollower::follow(int grasp, const GraspInput& input, double dt,
                                 elasticity::DeformationModel& model,
                                 const math::Pose& correction) noexcept {
  Hand& hand = hands_[grasp];
  const char* trouble = "";
  hand.age += dt;
  if (input.pose_freshness == sensing::Freshness::kNew) {
    if (input.X_OG.matrix().allFinite()) {
      hand.hand = input.X_OG;
      hand.age = 0;
      hand.seen = true;
    } else {
      trouble = "pose of the hand is not finite";
    }
  }
  if (!hand.seen) return *trouble != '\0' ? trouble : "no pose of the hand yet";

  const math::Pose goal = hand.hand * correction;
  if (!input.holding) {
    if (model.is_held(grasp)) model.release(grasp);
    hand.held = goal;
  } else {
    // What was let go has moved on its own: take it up where it is.
    if (!model.is_held(grasp))
      hand.held = elasticity::grasp_pose(model.body(), grasp, model.positions());
    if (!approach(hand, goal, dt)) trouble = "model has not reached the hand's pose";
    model.hold(grasp, hand.held);
  }
  if (hand.age > options_.pose_timeout) trouble = "pose of the hand is stale";
  return trouble;
}

/// True where the held pose is the hand's, or will be in a few steps: after a gap between two poses
/// the hand has gone on.
bool HandFollower::approach(Hand& hand, const math::Pose& goal, double dt) const noexcept {
  const Eigen::Vector3d way = goal.translation() - hand.held.translation();
  const Eigen::Vector3d turn = math::log_rotation(goal.linear() * hand.held.linear().transpose());
  const double share = std::max(way.norm() / (options_.approach_speed * dt),
                                turn.norm() / (options_.approach_angular_speed * dt));
  constexpr double kSoon = 5;  // steps
  if (!(share > 1)) {
    hand.held = goal;
    return true;
  }
  hand.held.translation() += way / share;
  hand.held.linear() = math::exp_rotation(turn / share) * hand.held.linear();
  return share <= kSoon;
}

}  // namespace palpate::estimation
