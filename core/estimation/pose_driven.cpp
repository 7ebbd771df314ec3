#include "core/estimation/pose_driven.hpp"

#include <stdexcept>

#include "core/elasticity/grasp_pose.hpp"
#include "core/estimation/nodal_loads.hpp"

namespace palpate::estimation {

PoseDriven::PoseDriven(const Options& options) : options_(options), step_watch_(options.step) {
  if (!(options.pose_timeout > 0) || !(options.approach_speed > 0) ||
      !(options.approach_angular_speed > 0)) {
    throw std::invalid_argument("timeout and speeds of the pose-driven estimator must be positive");
  }
}

void PoseDriven::reset() noexcept {
  hands_.fill(Hand());
  step_watch_.reset();
}

void PoseDriven::activate(elasticity::DeformationModel& model) noexcept {
  reset();
  const elasticity::Body& body = model.body();
  model.set_gravity(body.gravity_O);
  for (int i = 0; i < static_cast<int>(body.grasps.size()); ++i) {
    hands_[i].hand = hands_[i].held = body.grasps[i].X_OG_rest;
    model.hold(i, hands_[i].held);
  }
}

void PoseDriven::take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept {
  activate(model);
  for (int i = 0; i < static_cast<int>(model.body().grasps.size()); ++i) {
    if (!last.X_OG[i].matrix().allFinite()) continue;
    hands_[i].hand = hands_[i].held = last.X_OG[i];
    hands_[i].seen = true;
    model.hold(i, hands_[i].held);
  }
}

sensing::UpdateResult PoseDriven::update(const EstimationInputs& inputs,
                                         elasticity::DeformationModel& model,
                                         Estimate& estimate) noexcept {
  const char* trouble = "";
  if (!step_guard_.accepts(inputs.dt)) trouble = "time step is not positive and finite";
  const double dt = step_guard_.step();

  const int grasps = std::min(inputs.grasp_count, static_cast<int>(model.body().grasps.size()));
  for (int i = 0; i < grasps; ++i) {
    const char* grasp_trouble = follow(i, inputs.grasps[i], dt, model);
    if (*grasp_trouble != '\0') trouble = grasp_trouble;
  }

  model.loads().setZero();
  for (int i = 0; i < inputs.contact_count; ++i) {
    const contact::ContactLoads& contact = inputs.contacts[i];
    // What the wrist feels is the reaction of the held grasp: it must not be applied again.
    if (!contact.accepted || is_wrist(contact.source)) continue;
    for (const contact::NodalLoad& load : contact.loads) {
      if (is_valid(load, model.body().mesh.node_count())) {
        model.loads().col(load.node) += load.force;
      } else {
        trouble = "a contact load is not valid";
      }
    }
  }

  estimate.step = model.step(dt);
  for (int i = 0; i < grasps; ++i) {
    estimate.X_OG[i] = hands_[i].held;
    estimate.reaction[i] = model.reaction(i);
  }
  estimate.log_young_modulus = std::log(model.body().material.young_modulus);
  estimate.poisson_ratio = model.body().material.poisson_ratio;

  const sensing::UpdateResult step = step_watch_.judge(estimate.step, dt);
  if (step.status != sensing::Status::kOk || *trouble == '\0') return step;
  return {sensing::Status::kDegraded, trouble};
}

/// Takes the hand's pose and lets the model hold or release the grasp. Returns what is wrong, or
/// "".
const char* PoseDriven::follow(int grasp, const GraspInput& input, double dt,
                               elasticity::DeformationModel& model) noexcept {
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

  if (!input.holding) {
    if (model.is_held(grasp)) model.release(grasp);
    hand.held = hand.hand;
  } else {
    // What was let go has moved on its own: take it up where it is.
    if (!model.is_held(grasp))
      hand.held = elasticity::grasp_pose(model.body(), grasp, model.positions());
    if (!approach(hand, dt)) trouble = "model has not reached the hand's pose";
    model.hold(grasp, hand.held);
  }
  if (hand.age > options_.pose_timeout) trouble = "pose of the hand is stale";
  return trouble;
}

/// True where the held pose is the hand's, or will be in a few steps: after a gap between two poses
/// the hand has gone on.
bool PoseDriven::approach(Hand& hand, double dt) const noexcept {
  const Eigen::Vector3d way = hand.hand.translation() - hand.held.translation();
  const Eigen::Vector3d turn =
      math::log_rotation(hand.hand.linear() * hand.held.linear().transpose());
  const double share = std::max(way.norm() / (options_.approach_speed * dt),
                                turn.norm() / (options_.approach_angular_speed * dt));
  constexpr double kSoon = 5;  // steps
  if (!(share > 1)) {
    hand.held = hand.hand;
    return true;
  }
  hand.held.translation() += way / share;
  hand.held.linear() = math::exp_rotation(turn / share) * hand.held.linear();
  return share <= kSoon;
}

}  // namespace palpate::estimation
