#include "tools/lab/baselines/sensing/cloud_estimator.hpp"

#include <cmath>
#include <stdexcept>

#include "core/elasticity/body.hpp"

namespace palpate::baselines {

using estimation::EstimationInputs;

CloudEstimator::CloudEstimator(const elasticity::Body& body, const mesh::Surface& surface,
                               const Options& options)
    : options_(options),
      matches_(surface, options.reach, options.points_per_tick),
      follower_(options.follower),
      step_watch_(options.step),
      rest_(body.mesh.nodes),
      still_(Eigen::Matrix3Xd::Zero(3, body.mesh.node_count())) {
  if (!(options.patience > 0))
    throw std::invalid_argument("patience of an estimator that sees must be positive");
}

void CloudEstimator::reset() noexcept {
  matches_.reset();
  follower_.reset();
  step_watch_.reset();
  seen_ = false;
  unseen_for_ = 0;
  begin(rest_);
}

void CloudEstimator::activate(elasticity::DeformationModel& model) noexcept {
  reset();
  model.set_gravity(model.body().gravity_O);
  model.loads().setZero();
  if (options_.hand) follower_.activate(model);
  for (int g = 0; !options_.hand && g < static_cast<int>(model.body().grasps.size()); ++g)
    model.release(g);
}

void CloudEstimator::take_over(const estimation::Estimate& last,
                               elasticity::DeformationModel& model) noexcept {
  activate(model);
  if (options_.hand) follower_.take_over(last, model);
  begin(model.positions());
}

UpdateResult CloudEstimator::update(const EstimationInputs& inputs,
                                    elasticity::DeformationModel& model,
                                    estimation::Estimate& estimate) noexcept {
  UpdateResult result;
  if (!step_guard_.accepts(inputs.dt))
    result = {Status::kDegraded, "time step is not positive and finite"};
  const double dt = step_guard_.step();
  const elasticity::Body& body = model.body();
  const int grasps = std::min(inputs.grasp_count, static_cast<int>(body.grasps.size()));
  for (int g = 0; options_.hand && g < grasps; ++g) {
    result.take(follower_.follow(g, inputs.grasps[g], dt, model));
  }
  const bool is_new =
      inputs.observation.freshness == Freshness::kNew && inputs.observation.points_O.cols() > 0;
  unseen_for_ = is_new ? 0 : unseen_for_ + dt;
  if (unseen_for_ > options_.patience) {
    result = {Status::kDegraded, "nothing is seen of the shape"};
    // With a known pose of the hand the model continues; old observations would only hold the shape
    // back.
    if (options_.hand) matches_.reset();
  }
  if (is_new) matches_.begin(inputs.observation.points_O);
  seen_ = seen_ || is_new;
  if (matches_.advance(model.positions())) take(model);

  estimate.step = elasticity::StepReport{elasticity::StepStatus::kConverged, 0, 0};
  if (seen_) estimate.step = advance(dt, inputs, model);
  estimate.log_young_modulus = std::log(body.material.young_modulus);
  estimate.poisson_ratio = body.material.poisson_ratio;
  for (int g = 0; g < grasps; ++g) {
    estimate.X_OG[g] =
        options_.hand ? follower_.X_OG(g) : elasticity::grasp_pose(body, g, model.positions());
    estimate.reaction[g] = model.reaction(g);
  }
  report(estimate);
  const UpdateResult step = step_watch_.judge(estimate.step, dt);
  return step.is_ok() ? result : step;
}

Eigen::Vector3d CloudEstimator::held_place(int grasp, int node,
                                           const elasticity::Body& body) const noexcept {
  const math::Pose& rest = body.grasps[grasp].X_OG_rest;
  const Eigen::Vector3d p_G =
      rest.linear().transpose() * (body.mesh.nodes.col(node) - rest.translation());
  return follower_.X_OG(grasp) * p_G;
}

elasticity::StepReport CloudEstimator::carry(const Eigen::Matrix3Xd& shape,
                                             elasticity::DeformationModel& model) noexcept {
  elasticity::StepReport report;
  if (model.restore(shape, still_)) report.status = elasticity::StepStatus::kConverged;
  return report;
}

void pull_to_cloud(const CloudMatches& matches, double stiffness, double damping,
                   const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& velocities,
                   Eigen::Matrix3Xd& loads) noexcept {
  const double share = 1.0 / std::max(1, matches.count());
  for (int i = 0; i < matches.count(); ++i) {
    const CloudMatch& match = matches[i];
    const Eigen::Vector3d force =
        share * (stiffness * (match.point - match.of(positions)) - damping * match.of(velocities));
    for (int k = 0; k < match.place.count; ++k)
      loads.col(match.place.nodes[k]) += match.place.weights[k] * force;
  }
}

}  // namespace palpate::baselines
