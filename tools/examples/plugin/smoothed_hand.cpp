#include "smoothed_hand.hpp"

#include <cmath>

namespace example {

using palpate::Status;

palpate::config::OptionTable<SmoothedHand::Options> SmoothedHand::table() {
  return palpate::config::OptionTable<Options>()
      .number("time_constant_ms", "ms", "of the filter of the hand's pose", {0.1, 1e4},
              &Options::time_constant, 1e-3)
      .number("max_age_ms", "ms", "without a new pose, until it counts as old", {1, 1e4},
              &Options::max_age, 1e-3);
}

void SmoothedHand::activate(palpate::elasticity::DeformationModel& model) {
  reset();
  model.set_gravity(model.body().gravity_O);
  const auto& grasps = model.body().grasps;
  for (std::size_t i = 0; i < grasps.size(); ++i) {
    poses_[i] = grasps[i].X_OG_rest;
    model.hold(static_cast<int>(i), poses_[i]);
  }
}

void SmoothedHand::take_over(const palpate::estimation::Estimate& last,
                             palpate::elasticity::DeformationModel& model) {
  activate(model);
  for (std::size_t i = 0; i < model.body().grasps.size(); ++i) {
    poses_[i] = last.X_OG[i];
    model.hold(static_cast<int>(i), poses_[i]);
  }
}

palpate::UpdateResult SmoothedHand::update(const palpate::estimation::EstimationInputs& inputs,
                                           palpate::elasticity::DeformationModel& model,
                                           palpate::estimation::Estimate& estimate) {
  palpate::UpdateResult result;
  const double share = 1 - std::exp(-inputs.dt / options_.time_constant);
  for (int i = 0; i < inputs.grasp_count; ++i) {
    const palpate::estimation::GraspInput& grasp = inputs.grasps[i];
    ages_[i] = grasp.pose_freshness == palpate::Freshness::kNew ? 0 : ages_[i] + inputs.dt;
    if (ages_[i] > options_.max_age) result = {Status::kDegraded, "the pose of a hand is too old"};
    if (!grasp.holding) {
      model.release(i);
      continue;
    }
    palpate::math::Pose& pose = poses_[i];
    pose.translation() += share * (grasp.X_OG.translation() - pose.translation());
    const Eigen::Quaterniond from(pose.linear()), to(grasp.X_OG.linear());
    pose.linear() = from.slerp(share, to).toRotationMatrix();
    model.hold(i, pose);
  }
  model.loads().setZero();
  for (int c = 0; c < inputs.contact_count; ++c) {
    // The wrench at the wrist is the reaction of the grasp, which the model has already.
    const auto& contact = inputs.contacts[c];
    if (!contact.accepted || contact.source == palpate::sensing::Source::kWrist0 ||
        contact.source == palpate::sensing::Source::kWrist1)
      continue;
    for (const auto& load : contact.loads) model.loads().col(load.node) += load.force;
  }
  estimate.step = model.step(inputs.dt);
  for (int i = 0; i < inputs.grasp_count; ++i) {
    estimate.X_OG[i] = poses_[i];
    estimate.reaction[i] = model.reaction(i);
  }
  estimate.log_young_modulus = std::log(model.body().material.young_modulus);
  estimate.poisson_ratio = model.body().material.poisson_ratio;
  if (estimate.step.status == palpate::elasticity::StepStatus::kFailed)
    return {Status::kDegraded, "the model failed in this step"};
  return result;
}

}  // namespace example
