#include "core/estimation/hand_follower.hpp"

#include "core/elasticity/body.hpp"
#include "core/math/option_check.hpp"

namespace palpate::estimation {
namespace {

/// Compliance of the grasp under the reaction predicted by the model, for an object `stiffness`
/// times as stiff as the model.
math::Matrix6d compliance_of(const elasticity::GraspRegion& grasp, double stiffness) noexcept {
  return stiffness * grasp.compliance + grasp.object_compliance;
}

/// Displacement (m, rad) from one pose to another, in the axes of the first.
math::Vector6d displacement_between(const math::Pose& from, const math::Pose& to) noexcept {
  const math::Pose motion = from.inverse() * to;
  math::Vector6d displacement;
  displacement << motion.translation(), math::log_rotation(motion.linear());
  return displacement;
}

}  // namespace

HandFollower::HandFollower(const Options& options) : options_(options) {
  math::check_positive(options.pose_timeout, "pose_timeout");
  math::check_positive(options.approach_speed, "approach_speed");
  math::check_positive(options.approach_angular_speed, "approach_angular_speed");
  math::check_positive(options.pad_time, "pad_time");
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
    hands_[i].inherited = true;
    model.hold(i, hands_[i].held);
  }
}

/// Advances the pad deflection by the fraction `share` towards its equilibrium under `reaction`,
/// the predicted wrench of the hand at G, in O.
void HandFollower::deflect(Hand& hand, int grasp, double share, const math::Wrench& reaction,
                           double stiffness, const elasticity::Body& body) const noexcept {
  const math::Vector6d wrench =
      math::both_halves(hand.held.linear()).transpose() * reaction.vector();
  if (!wrench.allFinite()) return;
  const math::Vector6d goal = -(compliance_of(body.grasps[grasp], stiffness) * wrench);
  hand.deflection += share * (goal - hand.deflection);
}

/// The relaxation with this fraction is stable if share (1 + c k) < 2 for the eigenvalues c k of
/// compliance times stiffness; the trace bounds the largest of them.
double HandFollower::pad_share(int grasp, double dt, double stiffness,
                               const elasticity::DeformationModel& model) const noexcept {
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  const math::Matrix6d C = compliance_of(model.body().grasps[grasp], stiffness);
  if (C(0, 0) == 0) return 1;  // rigid grasp
  if (!sensitivity.valid) return 0;
  const math::Matrix6d turn = math::both_halves(hands_[grasp].held.linear());
  const math::Matrix6d K = turn.transpose() * sensitivity.dw_dxi[grasp][grasp] * turn;
  const double softness = std::max(0.0, C.cwiseProduct(K.transpose()).sum());
  return std::min(1.0, dt / options_.pad_time) / (1 + softness);
}

UpdateResult HandFollower::follow(int grasp, const GraspInput& input, double dt,
                                  elasticity::DeformationModel& model, const math::Pose& correction,
                                  double stiffness) noexcept {
  Hand& hand = hands_[grasp];
  UpdateResult result;
  hand.age += dt;
  if (input.pose_freshness == Freshness::kNew) {
    if (input.X_OG.matrix().allFinite()) {
      hand.hand = input.X_OG;
      hand.age = 0;
      hand.seen = true;
    } else {
      result = {Status::kDegraded, "pose of the hand is not finite"};
    }
  }
  if (!hand.seen)
    return result.is_ok() ? UpdateResult{Status::kDegraded, "no pose of the hand yet"} : result;

  math::Pose goal = hand.hand * correction;
  if (hand.inherited) {
    hand.inherited = false;
    if (model.is_held(grasp)) hand.deflection = displacement_between(goal, hand.held);
  }
  if (model.is_held(grasp)) {
    deflect(hand, grasp, pad_share(grasp, dt, stiffness, model), model.reaction(grasp), stiffness,
            model.body());
  } else {
    hand.deflection.setZero();
  }
  goal.translation() += goal.linear() * hand.deflection.head<3>();
  goal.linear() *= math::exp_rotation(hand.deflection.tail<3>());
  if (!input.holding) {
    if (model.is_held(grasp)) model.release(grasp);
    hand.held = goal;
  } else {
    // a released grasp has moved freely: continue from its present pose
    if (!model.is_held(grasp))
      hand.held = elasticity::grasp_pose(model.body(), grasp, model.positions());
    if (!approach(hand, goal, dt))
      result = {Status::kDegraded, "model has not reached the hand's pose"};
    model.hold(grasp, hand.held);
  }
  if (hand.age > options_.pose_timeout) result = {Status::kDegraded, "pose of the hand is stale"};
  return result;
}

/// True if the held pose equals the hand's or will within a few steps, as after a gap between two
/// poses during which the hand has moved.
bool HandFollower::approach(Hand& hand, const math::Pose& goal, double dt) const noexcept {
  const Eigen::Vector3d displacement = goal.translation() - hand.held.translation();
  const Eigen::Vector3d turn = math::log_rotation(goal.linear() * hand.held.linear().transpose());
  const double share = std::max(displacement.norm() / (options_.approach_speed * dt),
                                turn.norm() / (options_.approach_angular_speed * dt));
  constexpr double kSoon = 5;  // steps
  if (!(share > 1)) {
    hand.held = goal;
    return true;
  }
  hand.held.translation() += displacement / share;
  hand.held.linear() = math::exp_rotation(turn / share) * hand.held.linear();
  return share <= kSoon;
}

}  // namespace palpate::estimation
