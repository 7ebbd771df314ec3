#include "core/estimation/pose_wrench_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/estimation/nodal_loads.hpp"

namespace palpate::estimation {
namespace {

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
    : options_(options),
      follower_(options.hand),
      step_watch_(options.step),
      filter_(static_cast<int>(body.grasps.size()), options.filter),
      motion_(filter_.shape_size()),
      search_(body, surface, options.search),
      loads_(body),
      observation_fit_(body.mesh.nodes, surface, options.sight),
      history_(body.mesh.node_count()),
      shift_(WrenchFilter::ShapeState::Zero(filter_.shape_size())),
      node_deviation_(static_cast<std::size_t>(body.mesh.node_count()), 0.0F) {
  const Eigen::Vector3d middle = body.mesh.nodes.rowwise().mean();
  for (std::size_t g = 0; g < body.grasps.size(); ++g)
    lever_[g] = (body.grasps[g].X_OG_rest.translation() - middle).norm();
  for (const double value : {options.period, options.way, options.turn, options.correlation,
                             options.force, options.torque, options.lag, options.lag_deviation,
                             options.gate, options.shape, options.fade}) {
    if (!(value > 0))
      throw std::invalid_argument("times, deviations and gate of a filter must be positive");
  }
  if (!(options.relative >= 0) || !(options.payload_error >= 0) || options.suspicions < 1)
    throw std::invalid_argument(
        "a filter's relative error and error of the payload must not be negative, and it must be "
        "suspicious at least once before it looks for a contact");
}

void PoseWrenchFilter::reset() noexcept {
  follower_.reset();
  step_watch_.reset();
  filter_.reset();
  observation_fit_.reset();
  history_.clear();
  is_seen_ = false;
  shift_.setZero();
  hands_.fill(Hand());
  since_taken_ = 0;
  innovation_test_ = -1;
  rejected_innovations_ = 0;
  place_ = -1;
  weak_for_ = unbelieved_for_ = 0;
  since_contact_ = kLongAgo;
  unexplained_count_ = 0;
  sudden_ = 0;
  contact_released_ = false;
  rest_for_ = 0;
  at_rest_count_ = 0;
  std::fill(node_deviation_.begin(), node_deviation_.end(), 0.0F);
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
  carry_over(filter_.log_young(),
             last.log_young_modulus - std::log(model.body().material.young_modulus),
             last.log_young_modulus_deviation, filter_);
  for (int g = 0; g < filter_.grasp_count(); ++g) {
    for (int i = 0; i < 6; ++i) {
      carry_over(filter_.offset(g) + i, last.pose_offset[g][i], last.pose_deviation[g][i], filter_);
      carry_over(filter_.bias(g) + i, last.bias[g][i], last.bias_deviation[g][i], filter_);
    }
  }
}

WrenchFilter::ShapeState PoseWrenchFilter::applied() const noexcept {
  return filter_.mean().head(filter_.shape_size()) + shift_;
}

double PoseWrenchFilter::stiffness() const noexcept {
  constexpr double kMost = 3;  // a factor of 20
  const int i = filter_.log_young();
  return std::exp(std::clamp(filter_.mean()[i] + shift_[i], -kMost, kMost));
}

math::Pose PoseWrenchFilter::correction(int grasp) const noexcept {
  const int first = filter_.offset(grasp);
  const math::Vector6d offset = filter_.mean().segment<6>(first) + shift_.segment<6>(first);
  return math::make_pose(math::exp_rotation(offset.tail<3>()), offset.head<3>());
}

sensing::UpdateResult PoseWrenchFilter::update(const EstimationInputs& inputs,
                                               elasticity::DeformationModel& model,
                                               Estimate& estimate) noexcept {
  const char* trouble = "";
  if (!step_guard_.accepts(inputs.dt)) trouble = "time step is not positive and finite";
  const double dt = step_guard_.step();
  const int grasps = std::min(inputs.grasp_count, filter_.grasp_count());
  for (int i = 0; i < grasps; ++i) {
    const char* grasp_trouble =
        follower_.follow(i, inputs.grasps[i], dt, model, correction(i), stiffness());
    if (*grasp_trouble != '\0') trouble = grasp_trouble;
  }
  model.set_gravity(model.body().gravity_O / stiffness());
  if (!load_with_contacts(inputs, 1 / stiffness(), model)) trouble = "a contact load is not valid";
  load_with_unknown(model);
  if (filter_.has_loads())
    loads_.add_to(model.loads(), applied().segment<WrenchFilter::kLoads>(filter_.load()));
  estimate.step = model.step(dt);

  if (model.sensitivity().valid)
    motion_.update(model, filter_, {follower_.X_OG(0), follower_.X_OG(1)}, stiffness());
  filter_.predict(dt);
  for (int i = 0; i < grasps; ++i) predict_wrench(i, inputs.grasps[i], model, dt);
  bool moves = false;
  for (int i = 0; i < grasps; ++i) moves = has_moved(i, inputs.grasps[i], dt) || moves;
  rest_for_ = moves ? 0 : rest_for_ + dt;
  since_taken_ += dt;
  if (since_taken_ >= options_.period * (1 - 1e-9)) {
    since_taken_ = 0;
    update_wrench(model);
  }
  update_observation(inputs.observation, model, dt);
  if (search_.is_searching()) {
    constexpr int kPlaces = 1000;  // per tick, 0.2 ms
    if (search_.advance(model, motion_, kPlaces)) judge_search(model);
  }
  judge_contact(model, dt);
  write_estimate(model, grasps, estimate);

  const sensing::UpdateResult step = step_watch_.judge(estimate.step, dt);
  if (step.status != sensing::Status::kOk) return step;
  if (rejected_innovations_ * options_.period > kPatience / 2)
    trouble = "nothing explains the wrench of the hand";
  if (*trouble != '\0') return {sensing::Status::kDegraded, trouble};
  return {};
}

void PoseWrenchFilter::predict_wrench(int grasp, const GraspInput& input,
                                      const elasticity::DeformationModel& model,
                                      double dt) noexcept {
  Hand& hand = hands_[grasp];
  if (!model.is_held(grasp)) {
    hand = Hand();
    return;
  }
  const math::Pose& X_OG = follower_.X_OG(grasp);
  math::Vector6d wrench = stiffness() * model.reaction(grasp).vector();
  if (is_seen_) wrench -= wrench_of_shift(grasp, model);
  if (!hand.known) {
    hand.known = true;
    hand.lagged = wrench;
    hand.X_OG_before = X_OG;
  }
  math::Vector6d speed;
  speed << (X_OG.translation() - hand.X_OG_before.translation()) / dt,
      math::log_rotation(X_OG.linear() * hand.X_OG_before.linear().transpose()) / dt;
  hand.X_OG_before = X_OG;
  hand.information_gain =
      std::min(1.0, hand.information_gain +
                        dt * (speed.head<3>().norm() / options_.way +
                              speed.tail<3>().norm() / options_.turn + 1 / options_.correlation));
  const double share = 1 - std::exp(-dt / options_.lag);
  hand.lagged += share * (wrench - hand.lagged);
  const math::Vector6d faster = share * (speed - hand.speed);
  hand.speed += faster;
  constexpr double kOfLate = 0.05;  // s
  hand.acceleration += std::min(1.0, dt / kOfLate) * (faster / dt - hand.acceleration);
  if (!input.wrench_valid) return;
  const math::Vector6d measured = input.F_G_O.vector();
  if (!measured.allFinite()) return;
  hand.sum += measured - hand.lagged;
  hand.sum_measured += measured;
  ++hand.count;
}

void PoseWrenchFilter::update_wrench(const elasticity::DeformationModel& model) noexcept {
  const Innovation now = innovation(model);
  if (now.y.size() == 0) return;
  find_reaction_deviation(now);
  if (rest_for_ < options_.period) {  // moved since the last wrench update
    at_rest_count_ = rejected_innovations_ = sudden_ = unexplained_count_ = 0;
    drop_contact(model);  // the wrench of a moving hand can no longer identify the contact
  }
  if (rest_for_ > options_.rest) accumulate_innovation(now);
  if (filter_.has_contact()) {
    if (is_settled(now)) follow_contact(change(now));
    return;
  }
  const double test = filter_.test(now.H, now.y, now.R);
  innovation_test_ = test / static_cast<double>(now.y.size());
  if (test < 0) return;
  if (!options_.contacts) {
    rejected_innovations_ = 0;
  } else if (is_settled(now)) {
    detect_contact(change(now));
    if (rejected_innovations_ > 0) return;
  }
  if (rest_for_ > options_.rest) update_rest_baseline(now);
  if (filter_.test(now.H, now.y, now.R) <= options_.gate / 6 * static_cast<double>(now.y.size()))
    correct(now);
}

void PoseWrenchFilter::correct(const Innovation& now) noexcept {
  const WrenchFilter::Vector before = filter_.mean();
  filter_.correct();
  for (int g = 0; g < filter_.grasp_count(); ++g)
    if (now.held[g])
      hands_[g].information_gain *= 1 - std::min(1.0, options_.period / kInformationTime);
  follow(now.held, now.H, filter_.mean() - before);
}

/// The prediction follows a correction of the state at once; the means of the innovation are
/// reduced accordingly, so that no information is used twice.
void PoseWrenchFilter::follow(const std::array<bool, 2>& held, const WrenchFilter::Rows& H,
                              WrenchFilter::Vector change) noexcept {
  const WrenchFilter::Wrenches off = H * change;  // the bias is not part of the prediction
  for (int g = 0; g < filter_.grasp_count(); ++g) change.segment<6>(filter_.bias(g)).setZero();
  for (int g = 0, row = 0; g < filter_.grasp_count(); ++g) {
    if (!held[g]) continue;
    hands_[g].lagged += H.middleRows<6>(row) * change;
    row += 6;
  }
  if (at_rest_count_ == 0 || recent_.size() != off.size()) return;
  recent_ -= off;  // the bias is part of the innovation
  if (!filter_.has_contact()) at_rest_ -= off;
}

void PoseWrenchFilter::write_estimate(const elasticity::DeformationModel& model, int grasps,
                                      Estimate& estimate) noexcept {
  const WrenchFilter::Vector& mean = filter_.mean();
  for (int g = 0; g < grasps; ++g) {
    estimate.X_OG[g] = follower_.X_OG(g);
    estimate.reaction[g] = math::Wrench::from(stiffness() * model.reaction(g).vector());
    estimate.reaction_deviation[g] = hands_[g].reaction_deviation;
    estimate.bias[g] = mean.segment<6>(filter_.bias(g));
    estimate.pose_offset[g] = mean.segment<6>(filter_.offset(g));
    for (int i = 0; i < 6; ++i) {
      estimate.pose_deviation[g][i] = filter_.deviation(filter_.offset(g) + i);
      const int bias = filter_.bias(g) + i;
      estimate.bias_deviation[g][i] = filter_.is_observed(bias) ? filter_.deviation(bias) : -1;
    }
  }
  const int log_young = filter_.log_young();
  estimate.log_young_modulus = std::log(model.body().material.young_modulus) + mean[log_young];
  estimate.log_young_modulus_deviation =
      filter_.is_observed(log_young) ? filter_.deviation(log_young) : -1;
  estimate.poisson_ratio = model.body().material.poisson_ratio;
  estimate.innovation_test = innovation_test_;

  UnknownContact& contact = estimate.unknown_contact;
  contact.found = filter_.has_contact();
  if (contact.found) {
    contact.location_O = search_.place(place_).point.interpolate(model.positions());
    contact.force_O = mean.tail<3>();
    contact.deviation = std::sqrt(filter_.covariance().diagonal().tail<3>().maxCoeff());
    contact.location_deviation =
        place_deviation_ <= options_.search.observable ? place_deviation_ : -1;
  } else {
    contact = UnknownContact();
  }
  write_node_deviations(model);
  estimate.node_deviation = &node_deviation_;
}

/// Updates the deviation of one tenth of the nodes per tick.
void PoseWrenchFilter::write_node_deviations(const elasticity::DeformationModel& model) noexcept {
  if (!model.sensitivity().valid) return;
  const SurfaceFit::Basis now = basis(model);
  const int columns = filter_.has_loads() ? filter_.shape_size() : filter_.load();
  SurfaceFit::NodeRows rows, J(3, columns), JP(3, columns);
  const double own =
      options_.sight.surface * options_.sight.surface;  // variance of the mesh itself
  const int nodes = static_cast<int>(node_deviation_.size());
  for (int i = 0; i < nodes / 10 + 1; ++i, next_node_ = (next_node_ + 1) % nodes) {
    rows.setZero(3, filter_.shape_size());
    SurfaceFit::add_node(now, next_node_, 1, rows);
    J.noalias() = rows * motion_.by_state().leftCols(columns);
    JP.noalias() = J * filter_.covariance().topLeftCorner(columns, columns);
    const double variance = JP.cwiseProduct(J).sum() / 3 + own;
    node_deviation_[static_cast<std::size_t>(next_node_)] =
        static_cast<float>(std::sqrt(std::max(0.0, variance)));
  }
}

}  // namespace palpate::estimation
