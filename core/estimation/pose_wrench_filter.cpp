#include "core/estimation/pose_wrench_filter.hpp"

#include <algorithm>
#include <cmath>

#include "core/estimation/nodal_loads.hpp"
#include "core/math/option_check.hpp"

namespace palpate::estimation {
namespace {

/// By hand and largest normalised component of the wrench.
constexpr const char* kContradictions[2][6] = {
    {"the force of hand 0 along x contradicts the model",
     "the force of hand 0 along y contradicts the model",
     "the force of hand 0 along z contradicts the model",
     "the torque of hand 0 about x contradicts the model",
     "the torque of hand 0 about y contradicts the model",
     "the torque of hand 0 about z contradicts the model"},
    {"the force of hand 1 along x contradicts the model",
     "the force of hand 1 along y contradicts the model",
     "the force of hand 1 along z contradicts the model",
     "the torque of hand 1 about x contradicts the model",
     "the torque of hand 1 about y contradicts the model",
     "the torque of hand 1 about z contradicts the model"}};

/// Gives a state of a newly reset filter this mean and deviation by an equivalent measurement. A
/// state that was not observable (negative deviation) or no more certain than the prior keeps most
/// of the prior's deviation.
void carry_over(int state, double mean, double deviation, WrenchFilter& filter) noexcept {
  // Fraction of the prior's deviation; above 0.9 a state counts as not observed.
  constexpr double kMost = 0.95;
  const double prior = filter.covariance()(state, state);
  const double wanted =
      deviation >= 0 ? std::min(deviation * deviation, kMost * prior) : kMost * prior;
  WrenchFilter::Rows H = WrenchFilter::Rows::Zero(1, filter.size());
  H(0, state) = 1;
  WrenchFilter::Wrenches y = WrenchFilter::Wrenches::Zero(1);
  y[0] = mean * prior / (prior - wanted);
  WrenchFilter::Noise R = WrenchFilter::Noise::Zero(1, 1);
  R(0, 0) = wanted * prior / (prior - wanted);
  if (R(0, 0) > 0 && filter.test(H, y, R) >= 0) filter.correct();
}

}  // namespace

PoseWrenchFilter::PoseWrenchFilter(const elasticity::Body& body, const mesh::Surface& surface,
                                   const Options& options)
    : follower_(options.hand),
      step_watch_(options.step),
      state_(static_cast<int>(body.grasps.size()), options.filter),
      period_(options.period),
      wrenches_(body, options),
      guard_(body, surface, options, options.filter, options.consistency),
      rest_(options),
      contact_(body, surface, options, options),
      observations_(body, surface, options),
      node_deviations_(body.mesh.node_count(), options.observation.surface, options.consistency,
                       options.deviations) {
  math::check_positive(options.period, "period");
  math::check_positive(options.decorrelation_distance, "decorrelation_distance");
  math::check_positive(options.decorrelation_angle, "decorrelation_angle");
  math::check_positive(options.correlation, "correlation");
  math::check_positive(options.force, "force");
  math::check_positive(options.torque, "torque");
  math::check_positive(options.lag, "lag");
  math::check_positive(options.lag_deviation, "lag_deviation");
  math::check_positive(options.gate, "gate");
  math::check_positive(options.shape, "shape");
  math::check_positive(options.fade, "fade");
  math::check_not_negative(options.relative, "relative");
  math::check_not_negative(options.payload_error, "payload_error");
  math::check_option(options.suspect_count >= 1, "suspect_count", options.suspect_count,
                     "at least 1");
}

void PoseWrenchFilter::reset() noexcept {
  follower_.reset();
  step_watch_.reset();
  state_.reset();
  wrenches_.reset();
  guard_.reset();
  rest_.reset();
  contact_.reset();
  observations_.reset();
  node_deviations_.reset();
}

void PoseWrenchFilter::activate(elasticity::DeformationModel& model) noexcept {
  reset();
  model.set_gravity(model.body().gravity_O);
  follower_.activate(model);
}

void PoseWrenchFilter::take_over(const Estimate& last,
                                 elasticity::DeformationModel& model) noexcept {
  activate(model);
  follower_.take_over(last, model);
  if (!(last.pose_deviation[0][0] >= 0)) return;  // not estimated before
  WrenchFilter& filter = state_.filter;
  carry_over(filter.log_young(),
             last.log_young_modulus - std::log(model.body().material.young_modulus),
             last.log_young_modulus_deviation, filter);
  for (int g = 0; g < filter.grasp_count(); ++g) {
    for (int i = 0; i < 6; ++i) {
      carry_over(filter.offset(g) + i, last.pose_offset[g][i], last.pose_deviation[g][i], filter);
      carry_over(filter.bias(g) + i, last.bias[g][i], last.bias_deviation[g][i], filter);
    }
  }
  for (int k = 0; k < filter.free_directions(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    carry_over(filter.obstacle() + k, last.obstacle_motion[i], last.obstacle_deviation[i], filter);
  }
  guard_.take_over(filter);
}

UpdateResult PoseWrenchFilter::update(const EstimationInputs& inputs,
                                      elasticity::DeformationModel& model,
                                      Estimate& estimate) noexcept {
  UpdateResult result;
  if (!step_guard_.accepts(inputs.dt))
    result = {Status::kDegraded, "time step is not positive and finite"};
  const double dt = step_guard_.step();
  const int grasps = std::min(inputs.grasp_count, state_.filter.grasp_count());
  result.take(set_boundary(inputs, grasps, dt, model));
  estimate.step = model.step(dt);

  if (model.sensitivity().valid)
    state_.motion.update(model, state_.filter, state_.X_OG, state_.stiffness());
  state_.filter.predict(dt);
  predict(inputs, grasps, dt, model);
  rest_.update(inputs.grasps, grasps, dt);
  if (wrenches_.is_due(dt)) update_wrench(model, result.is_ok());
  observations_.update(inputs.observation, state_, wrenches_, model, dt);
  contact_.advance(dt, state_, wrenches_, model);
  guard_.advance(dt);
  write_estimate(model, grasps, estimate);

  const UpdateResult step = step_watch_.judge(estimate.step, dt);
  // Only where nothing else is wrong may control move by an estimate in doubt.
  if (result.is_ok() && guard_.test().is_inconsistent()) {
    const WrenchConsistency::Discrepancy& found = guard_.test().discrepancy();
    result = {Status::kDoubtful, kContradictions[found.hand][found.axis]};
  } else if (result.is_ok() && contact_.detector().is_overdue()) {
    result = {Status::kDegraded, "nothing explains the wrench of the hand"};
  }
  return step.is_ok() ? result : step;
}

/// Sets grasps, gravity and loads of the model.
UpdateResult PoseWrenchFilter::set_boundary(const EstimationInputs& inputs, int grasps, double dt,
                                            elasticity::DeformationModel& model) noexcept {
  UpdateResult result;
  for (int i = 0; i < grasps; ++i) {
    result.take(
        follower_.follow(i, inputs.grasps[i], dt, model, state_.correction(i), state_.stiffness()));
  }
  state_.X_OG = {follower_.X_OG(0), follower_.X_OG(1)};
  model.set_gravity(model.body().gravity_O / state_.stiffness());
  if (!load_with_contacts(inputs, 1 / state_.stiffness(), model))
    result = {Status::kDegraded, "a contact load is not valid"};
  state_.load_with_contact(model);
  observations_.add_loads(state_, model.loads());
  return result;
}

void PoseWrenchFilter::predict(const EstimationInputs& inputs, int grasps, double dt,
                               const elasticity::DeformationModel& model) noexcept {
  for (int i = 0; i < grasps; ++i) {
    if (!model.is_held(i)) {
      wrenches_.release(i);
      rest_.release(i);
      continue;
    }
    math::Vector6d wrench = state_.stiffness() * model.reaction(i).vector();
    if (observations_.is_active() || !state_.shift.isZero(0))
      wrench -= state_.wrench_of_shift(i, model);
    wrenches_.predict(i, wrench, state_.X_OG[i], inputs.grasps[i], dt);
  }
}

/// `follows`: whether the model is held at the poses of the hands.
void PoseWrenchFilter::update_wrench(const elasticity::DeformationModel& model,
                                     bool follows) noexcept {
  const Innovation now = wrenches_.take_innovation(state_, model);
  if (now.y.size() == 0) return;
  const bool has_moved = rest_.rest_time() < period_;  // since the last wrench update
  if (has_moved) contact_.restart(state_, wrenches_, model);
  if (rest_.is_at_rest()) wrenches_.baseline().accumulate(now);
  const bool has_contact = contact_.detector().state() != ContactDetector::State::kNone;
  const bool may_learn = !follows || guard_.permits(now, has_contact, state_, wrenches_, model);
  if (contact_.detector().has_contact()) {
    contact_.track(now, state_, wrenches_);
    return;
  }
  if (wrenches_.test(now, state_) < 0) return;
  if (contact_.detect(now, state_, wrenches_)) return;
  if (rest_.is_at_rest()) wrenches_.baseline().extend(now);
  if (may_learn && wrenches_.passes(now, state_)) wrenches_.correct(now, state_);
}

void PoseWrenchFilter::write_estimate(const elasticity::DeformationModel& model, int grasps,
                                      Estimate& estimate) noexcept {
  const WrenchFilter& filter = state_.filter;
  const WrenchFilter::Vector& mean = filter.mean();
  for (int g = 0; g < grasps; ++g) {
    estimate.X_OG[g] = follower_.X_OG(g);
    estimate.reaction[g] = math::Wrench::from(state_.stiffness() * model.reaction(g).vector());
    estimate.reaction_deviation[g] = wrenches_.reaction_deviation(g);
    estimate.bias[g] = mean.segment<6>(filter.bias(g));
    estimate.pose_offset[g] = mean.segment<6>(filter.offset(g));
    for (int i = 0; i < 6; ++i) {
      estimate.pose_deviation[g][i] = filter.deviation(filter.offset(g) + i);
      const int bias = filter.bias(g) + i;
      estimate.bias_deviation[g][i] = filter.is_observed(bias) ? filter.deviation(bias) : -1;
    }
  }
  const int log_young = filter.log_young();
  estimate.log_young_modulus = std::log(model.body().material.young_modulus) + mean[log_young];
  estimate.log_young_modulus_deviation =
      filter.is_observed(log_young) ? filter.deviation(log_young) : -1;
  estimate.poisson_ratio = model.body().material.poisson_ratio;
  for (int k = 0; k < filter.free_directions(); ++k) {
    const int state = filter.obstacle() + k;
    const auto i = static_cast<std::size_t>(k);
    estimate.obstacle_motion[i] = mean[state] + state_.shift[state];
    estimate.obstacle_deviation[i] = filter.deviation(state);
  }
  estimate.innovation_test = wrenches_.innovation_test();
  estimate.unknown_contact = contact_.estimate(filter, model);
  const WrenchConsistency& test = guard_.test();
  if (test.is_inconsistent())
    node_deviations_.widen(test.discrepancy().hand, test.discrepancy().wrench, state_);
  else
    node_deviations_.narrow();
  node_deviations_.update(state_, model);
  estimate.node_deviation = &node_deviations_.values();
  estimate.discrepancy = guard_.report();
}

}  // namespace palpate::estimation
