#include "core/estimation/wrench_driven.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/elasticity/body.hpp"
#include "core/estimation/nodal_loads.hpp"
#include "core/math/option_check.hpp"

namespace palpate::estimation {
namespace {

constexpr double kFar = 0.2;  // fraction of a wrench: a larger difference is not noise

bool lets_go(const GraspInput& input) noexcept {
  return input.pose_freshness != Freshness::kNoData && !input.holding;
}

}  // namespace

WrenchDriven::WrenchDriven(const elasticity::Body& body, const Options& options)
    : options_(options), step_watch_(options.step) {
  math::check_positive_finite(options.time_constant, "time_constant");
  math::check_positive_finite(options.average, "average");
  math::check_positive_finite(options.least_stiffness, "least_stiffness");
  math::check_positive_finite(options.wrench_timeout, "wrench_timeout");
  math::check_positive_finite(options.speed, "speed");
  math::check_positive_finite(options.angular_speed, "angular_speed");
  math::check_option(!body.fixed_nodes.empty(), "fixed_nodes", 0,
                     "at least one, without which a wrench does not determine the position");
  const Eigen::Matrix3Xd& nodes = body.mesh.nodes;
  length_ = (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).maxCoeff() / 2;
}

void WrenchDriven::reset() noexcept {
  hands_.fill(Hand());
  far_for_ = 0;
  step_watch_.reset();
}

void WrenchDriven::activate(elasticity::DeformationModel& model) noexcept {
  reset();
  model.set_gravity(model.body().gravity_O);
  const elasticity::Body& body = model.body();
  for (int g = 0; g < static_cast<int>(body.grasps.size()); ++g) {
    hands_[g].held = body.grasps[g].X_OG_rest;
    model.hold(g, hands_[g].held);
  }
}

void WrenchDriven::take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept {
  activate(model);
  for (int g = 0; g < static_cast<int>(model.body().grasps.size()); ++g) {
    if (!last.X_OG[g].matrix().allFinite()) continue;
    hands_[g].held = last.X_OG[g];
    model.hold(g, hands_[g].held);
  }
}

/// Takes the hand's wrench and holds or releases the grasp in the model.
UpdateResult WrenchDriven::take(int grasp, const GraspInput& input, double dt,
                                elasticity::DeformationModel& model) noexcept {
  Hand& hand = hands_[grasp];
  follows_[grasp] = false;
  if (lets_go(input)) {
    if (model.is_held(grasp)) model.release(grasp);
    hand = Hand();
    return {};
  }
  if (!model.is_held(grasp)) {  // a released grasp has moved freely
    hand = Hand();
    hand.held = elasticity::grasp_pose(model.body(), grasp, model.positions());
  }
  hand.age += dt;
  const math::Vector6d measured = input.F_G_O.vector();
  if (input.wrench_valid && measured.allFinite()) {
    const double share = hand.seen ? 1 - std::exp(-hand.age / options_.average) : 1;
    hand.wrench += share * (measured - hand.wrench);
    hand.seen = true;
    hand.age = 0;
  }
  if (hand.age > options_.wrench_timeout)
    return {Status::kDegraded,
            hand.seen ? "wrench of the hand is stale" : "no wrench of the hand yet"};
  follows_[grasp] = hand.seen && hand.answered;
  if (input.wrench_valid && !measured.allFinite())
    return {Status::kDegraded, "wrench of the hand is not finite"};
  return {};
}

/// Moves the grasps with a known wrench towards the poses at which the model's wrenches are equal
/// to it.
void WrenchDriven::move(const elasticity::Sensitivity& sensitivity, double dt) noexcept {
  math::Vector6d scale;  // scale of a motion and, inverted, of a wrench: all in m and N
  scale << 1, 1, 1, length_, length_, length_;
  const int rows = 6 * (follows_[0] + follows_[1]);
  if (rows == 0) return;
  Square K = Square::Zero(rows, rows);
  Column error = Column::Zero(rows), wrench = error;
  for (int a = 0, row = 0; a < 2; ++a) {
    if (!follows_[a]) continue;
    error.segment<6>(row) = (hands_[a].wrench - hands_[a].reaction).cwiseQuotient(scale);
    wrench.segment<6>(row) = hands_[a].wrench.cwiseQuotient(scale);
    for (int b = 0, column = 0; b < 2; ++b) {
      if (!follows_[b]) continue;
      K.block<6, 6>(row, column) =
          sensitivity.dw_dxi[a][b].cwiseQuotient(scale * scale.transpose());
      column += 6;
    }
    row += 6;
  }
  const bool far = error.norm() > options_.step.residual + kFar * wrench.norm();
  far_for_ = far ? far_for_ + dt : 0;
  Square damped = Square::Zero(rows, rows);
  damped.noalias() = K * K.transpose();
  damped.diagonal().array() += options_.least_stiffness * options_.least_stiffness;
  const Eigen::LLT<Square> factor(damped);
  factor.solveInPlace(error);
  Column motion = Column::Zero(rows);
  motion.noalias() = K.transpose() * error;
  motion *= 1 - std::exp(-dt / options_.time_constant);
  if (factor.info() != Eigen::Success || !motion.allFinite()) return;

  double excess = 1;  // ratio to the permitted motion; all motions are reduced by the same factor
  for (int row = 0; row < rows; row += 6) {
    motion.segment<6>(row) = motion.segment<6>(row).cwiseQuotient(scale).eval();
    excess = std::max({excess, motion.segment<3>(row).norm() / (options_.speed * dt),
                       motion.segment<3>(row + 3).norm() / (options_.angular_speed * dt)});
  }
  motion /= excess;
  for (int g = 0, row = 0; g < 2; ++g) {
    if (!follows_[g]) continue;
    math::Pose& held = hands_[g].held;
    held.translation() += motion.segment<3>(row);
    held.linear() = math::exp_rotation(motion.segment<3>(row + 3)) * held.linear();
    row += 6;
  }
}

UpdateResult WrenchDriven::update(const EstimationInputs& inputs,
                                  elasticity::DeformationModel& model,
                                  Estimate& estimate) noexcept {
  UpdateResult result;
  if (!step_guard_.accepts(inputs.dt))
    result = {Status::kDegraded, "time step is not positive and finite"};
  const double dt = step_guard_.step();

  follows_.fill(false);
  const int grasps = std::min(inputs.grasp_count, static_cast<int>(model.body().grasps.size()));
  for (int g = 0; g < grasps; ++g) {
    result.take(take(g, inputs.grasps[g], dt, model));
  }
  if (model.sensitivity().valid) {
    move(model.sensitivity(), dt);
    const double patience = options_.step.patience + 5 * options_.time_constant;
    if (far_for_ > patience)
      result = {Status::kDegraded, "no pose of the grasp has the wrench of the hand"};
  } else if (follows_[0] || follows_[1]) {
    far_for_ += dt;
    if (far_for_ > options_.wrench_timeout)
      result = {Status::kDegraded, "the model has no stiffness of the grasp yet"};
  }
  for (int g = 0; g < grasps; ++g) {
    if (!lets_go(inputs.grasps[g])) model.hold(g, hands_[g].held);
  }
  // The grasp is moved to reproduce the wrist wrench, which must not be applied again.
  if (!load_with_contacts(inputs, 1, model))
    result = {Status::kDegraded, "a contact load is not valid"};

  estimate.step = model.step(dt);
  const bool usable = estimate.step.status != elasticity::StepStatus::kFailed;
  for (int g = 0; g < grasps; ++g) {
    Hand& hand = hands_[g];
    if (usable) hand.reaction = model.reaction(g).vector();
    hand.answered = usable && model.is_held(g);
    estimate.X_OG[g] =
        model.is_held(g) ? hand.held : elasticity::grasp_pose(model.body(), g, model.positions());
    estimate.reaction[g] = model.reaction(g);
  }
  estimate.log_young_modulus = std::log(model.body().material.young_modulus);
  estimate.poisson_ratio = model.body().material.poisson_ratio;

  if (!model.velocities().isZero(0))
    return {Status::kFault, "a wrench can only drive a quasi-static model"};
  const UpdateResult step = step_watch_.judge(estimate.step, dt);
  return step.is_ok() ? result : step;
}

}  // namespace palpate::estimation
