#include "core/estimation/pose_wrench_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/estimation/nodal_loads.hpp"

namespace palpate::estimation {
namespace {

constexpr double kRecent = 0.2;  // weight of a new wrench in the mean of late
constexpr double kPatience = 2;  // s, with a change that nothing explains

/// Turns both halves of a twist or wrench.
math::Matrix6d both_halves(const Eigen::Matrix3d& R) noexcept {
  math::Matrix6d turn = math::Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R;
  return turn;
}

}  // namespace

PoseWrenchFilter::PoseWrenchFilter(const elasticity::Body& body, const mesh::Surface& surface,
                                   const Options& options)
    : options_(options),
      follower_(options.hand),
      step_watch_(options.step),
      filter_(static_cast<int>(body.grasps.size()), options.filter),
      search_(body, surface, options.search),
      node_deviation_(static_cast<std::size_t>(body.mesh.node_count()), 0.0F) {
  const Eigen::Vector3d middle = body.mesh.nodes.rowwise().mean();
  for (std::size_t g = 0; g < body.grasps.size(); ++g)
    lever_[g] = (body.grasps[g].X_OG_rest.translation() - middle).norm();
  for (const double value : {options.period, options.correlation, options.force, options.torque,
                             options.lag, options.lag_deviation, options.gate}) {
    if (!(value > 0))
      throw std::invalid_argument("period, deviations, lag and gate of a filter must be positive");
  }
  if (!(options.relative >= 0) || options.suspicions < 1)
    throw std::invalid_argument(
        "a filter's relative error must not be negative, and it must be "
        "suspicious at least once before it looks for a contact");
}

void PoseWrenchFilter::reset() noexcept {
  follower_.reset();
  step_watch_.reset();
  filter_.reset();
  hands_.fill(Hand());
  since_taken_ = 0;
  innovation_test_ = -1;
  suspicions_ = 0;
  place_ = -1;
  weak_for_ = 0;
  unexplained_count_ = 0;
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
}

double PoseWrenchFilter::stiffness() const noexcept {
  constexpr double kMost = 3;  // a factor of 20
  return std::exp(std::clamp(filter_.mean()[filter_.log_young()], -kMost, kMost));
}

math::Pose PoseWrenchFilter::correction(int grasp) const noexcept {
  const math::Vector6d offset = filter_.mean().segment<6>(filter_.offset(grasp));
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
    const char* grasp_trouble = follower_.follow(i, inputs.grasps[i], dt, model, correction(i));
    if (*grasp_trouble != '\0') trouble = grasp_trouble;
  }
  model.set_gravity(model.body().gravity_O / stiffness());
  if (!load_with_contacts(inputs, 1 / stiffness(), model)) trouble = "a contact load is not valid";
  load_with_unknown(model);
  estimate.step = model.step(dt);

  filter_.predict(dt);
  for (int i = 0; i < grasps; ++i) predict_wrench(i, inputs.grasps[i], model, dt);
  bool moves = false;
  for (int i = 0; i < grasps; ++i) moves = has_moved(i, inputs.grasps[i]) || moves;
  rest_for_ = moves ? 0 : rest_for_ + dt;
  since_taken_ += dt;
  if (since_taken_ >= options_.period * (1 - 1e-9)) {
    since_taken_ = 0;
    take(model);
  }
  if (search_.is_searching()) {
    const int share = std::max(1, search_.place_count() / 10);  // within ten ticks
    if (search_.advance(model, share)) judge_search(model);
  }
  judge_contact(model, dt);
  tell(model, grasps, estimate);

  const sensing::UpdateResult step = step_watch_.judge(estimate.step, dt);
  if (step.status != sensing::Status::kOk) return step;
  if (suspicions_ * options_.period > kPatience / 2)
    trouble = "nothing explains the wrench of the hand";
  if (*trouble != '\0') return {sensing::Status::kDegraded, trouble};
  return {};
}

void PoseWrenchFilter::load_with_unknown(elasticity::DeformationModel& model) const noexcept {
  if (!filter_.has_contact()) return;
  const Eigen::Vector3d force = filter_.mean().tail<3>() / stiffness();
  const mesh::PointWeights& point = search_.place(place_).point;
  for (int i = 0; i < point.count; ++i)
    model.loads().col(point.nodes[i]) += point.weights[i] * force;
}

/// From where it came to rest; then that is where it is now.
bool PoseWrenchFilter::has_moved(int grasp, const GraspInput& input) noexcept {
  if (!input.X_OG.matrix().allFinite()) return false;
  math::Pose& rest = hands_[grasp].X_OG_rest;
  const double way = (input.X_OG.translation() - rest.translation()).norm();
  const double turn = math::log_rotation(input.X_OG.linear() * rest.linear().transpose()).norm();
  if (way <= options_.rest_distance && turn <= 10 * options_.rest_distance) return false;
  rest = input.X_OG;
  return true;
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
  const math::Vector6d wrench = stiffness() * model.reaction(grasp).vector();
  if (!hand.known) {
    hand.known = true;
    hand.lagged = wrench;
    hand.X_OG_before = X_OG;
  }
  math::Vector6d speed;
  speed << (X_OG.translation() - hand.X_OG_before.translation()) / dt,
      math::log_rotation(X_OG.linear() * hand.X_OG_before.linear().transpose()) / dt;
  hand.X_OG_before = X_OG;
  const double share = 1 - std::exp(-dt / options_.lag);
  hand.lagged += share * (wrench - hand.lagged);
  hand.speed += share * (speed - hand.speed);
  if (!input.wrench_valid) return;
  const math::Vector6d measured = input.F_G_O.vector();
  if (!measured.allFinite()) return;
  hand.sum += measured;
  ++hand.count;
}

PoseWrenchFilter::Innovation PoseWrenchFilter::innovation(
    const elasticity::DeformationModel& model) noexcept {
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  const double k = stiffness();
  Innovation result;
  int rows = 0;
  for (int g = 0; g < filter_.grasp_count(); ++g) {
    result.held[g] = sensitivity.valid && model.is_held(g) && hands_[g].count > 0;
    rows += result.held[g] ? 6 : 0;
  }
  result.H = WrenchFilter::Rows::Zero(rows, filter_.size());
  result.y = WrenchFilter::Wrenches::Zero(rows);
  result.R = WrenchFilter::Noise::Zero(rows, rows);
  for (int g = 0, row = 0; g < filter_.grasp_count(); ++g) {
    Hand& hand = hands_[g];
    if (!result.held[g]) continue;
    const math::Matrix6d turn = both_halves(follower_.X_OG(g).linear());
    math::Vector6d late = math::Vector6d::Zero();  // what the wrench changes by in lag_deviation
    for (int other = 0; other < filter_.grasp_count(); ++other) {
      if (!model.is_held(other)) continue;
      const math::Matrix6d K = k * sensitivity.dw_dxi[g][other];
      result.H.block<6, 6>(row, filter_.offset(other)) =
          K * both_halves(follower_.X_OG(other).linear());
      late += K * hands_[other].speed * options_.lag_deviation;
    }
    result.H.block<6, 1>(row, filter_.log_young()) =
        k * sensitivity.dw_dparameter[g].col(elasticity::Sensitivity::kLogYoung);
    result.H.block<6, 6>(row, filter_.bias(g)) = turn;
    if (filter_.has_contact())
      result.H.block<6, 3>(row, filter_.contact()) =
          ContactSearch::response(search_.place(place_).point, sensitivity, g);
    result.y.segment<6>(row) =
        hand.sum / hand.count - hand.lagged - turn * filter_.mean().segment<6>(filter_.bias(g));
    // An error that lasts counts as one wrench's in the time that it lasts.
    const double lasting = options_.relative * std::sqrt(options_.correlation / options_.period);
    const double model_force = lasting * hand.lagged.head<3>().norm();
    const double model_torque = lasting * hand.lagged.tail<3>().norm() + lever_[g] * model_force;
    result.R.diagonal().segment<3>(row).setConstant(options_.force * options_.force +
                                                    model_force * model_force);
    result.R.diagonal().segment<3>(row + 3).setConstant(options_.torque * options_.torque +
                                                        model_torque * model_torque);
    result.R.block<6, 6>(row, row) += late * late.transpose();
    hand.sum.setZero();
    hand.count = 0;
    row += 6;
  }
  return result;
}

void PoseWrenchFilter::take(const elasticity::DeformationModel& model) noexcept {
  const Innovation now = innovation(model);
  if (now.y.size() == 0) return;
  if (rest_for_ == 0) {
    at_rest_count_ = 0;
    drop_contact(model);  // of a moving hand's wrench it cannot be told any more
  }
  if (filter_.has_contact()) {
    if (is_settled(now)) follow_contact(change(now));
    return;
  }
  const double test = filter_.test(now.H, now.y, now.R);
  innovation_test_ = test / static_cast<double>(now.y.size());
  if (test < 0) return;
  if (!options_.contacts) {
    suspicions_ = 0;
  } else if (is_settled(now)) {
    watch(change(now));
    if (suspicions_ > 0) return;
    settle(now);
  } else if (rest_for_ > options_.rest) {
    recent_ =
        at_rest_count_ == 0 ? now.y : WrenchFilter::Wrenches(recent_ + kRecent * (now.y - recent_));
    settle(now);
  }
  if (filter_.test(now.H, now.y, now.R) <= options_.gate / 6 * static_cast<double>(now.y.size()))
    correct(now);
}

bool PoseWrenchFilter::is_settled(const Innovation& now) const noexcept {
  constexpr int kEnough = 80;
  return at_rest_count_ >= kEnough && at_rest_.size() == now.y.size();
}

/// Learns how the wrenches are while nothing happens, and how they spread.
void PoseWrenchFilter::settle(const Innovation& now) noexcept {
  constexpr int kMost = 200;
  if (at_rest_count_ == 0 || at_rest_.size() != now.y.size()) {
    at_rest_ = recent_ = now.y;
    at_rest_spread_ = WrenchFilter::Wrenches::Zero(now.y.size());
    at_rest_count_ = 1;
    return;
  }
  at_rest_count_ = std::min(at_rest_count_ + 1, kMost);
  const WrenchFilter::Wrenches off = recent_ - at_rest_;
  at_rest_ += off / at_rest_count_;
  at_rest_spread_ += (off.cwiseAbs2() - at_rest_spread_) / at_rest_count_;
}

/// What has changed of late since the hands came to rest: a push can be behind it, the sensor's
/// noise, or an object that still swings, which shows in how the wrenches have spread.
PoseWrenchFilter::Innovation PoseWrenchFilter::change(const Innovation& now) noexcept {
  recent_ += kRecent * (now.y - recent_);
  Innovation result = now;
  result.y = recent_ - at_rest_;
  result.H.leftCols(filter_.contact()).setZero();
  result.R.setZero();
  for (int row = 0; row < result.y.size(); ++row) {
    const double noise = row % 6 < 3 ? options_.force : options_.torque;
    result.R(row, row) = std::max(kRecent / (2 - kRecent) * noise * noise, at_rest_spread_[row]);
  }
  return result;
}

/// Begins to look for a push where the wrenches have changed too much.
void PoseWrenchFilter::watch(const Innovation& changed) noexcept {
  const double test = filter_.test(changed.H, changed.y, changed.R);
  const bool suspicious = test > options_.gate / 6 * static_cast<double>(changed.y.size());
  suspicions_ = suspicious ? suspicions_ + 1 : 0;
  if (suspicions_ >= options_.suspicions && !search_.is_searching())
    search_.begin(changed.y, changed.R, changed.held);
  if (suspicions_ * options_.period > kPatience) at_rest_count_ = 0;  // then that is rest
}

void PoseWrenchFilter::follow_contact(Innovation changed) noexcept {
  changed.R *= (2 - kRecent) / kRecent;  // one mean of late tells little more than the one before
  const double test = filter_.test(changed.H, changed.y, changed.R);
  innovation_test_ = test / static_cast<double>(changed.y.size());
  if (test < 0) return;
  const WrenchFilter::Wrenches alone =
      changed.y + changed.H.rightCols<3>() * filter_.mean().tail<3>();
  const bool believed = test <= options_.gate / 6 * static_cast<double>(changed.y.size());
  suspicions_ = believed ? 0 : suspicions_ + 1;
  if (!believed) unexplained_count_ = 0;  // it has moved
  if (believed) correct(changed);
  constexpr int kMost = 50, kLookAgain = 10;
  if (unexplained_count_ == 0 || unexplained_.size() != alone.size()) unexplained_ = alone;
  unexplained_count_ = std::min(unexplained_count_ + 1, kMost);
  unexplained_ += (alone - unexplained_) / unexplained_count_;
  const bool look = suspicions_ >= options_.suspicions ||
                    (believed && weak_for_ == 0 && unexplained_count_ % kLookAgain == 0);
  if (!look || search_.is_searching()) return;
  // Of a mean's noise little remains, and the model's own error, a share of what the push does.
  WrenchFilter::Noise S = changed.R / unexplained_count_;
  for (int row = 0; row < S.rows(); row += 3) {
    const double error = options_.relative * unexplained_.segment<3>(row).norm();
    S.diagonal().segment<3>(row).array() += error * error;
  }
  search_.begin(unexplained_, S, changed.held);
}

/// The prediction follows what is learnt at once, and means of what it was off by with it, so that
/// nothing is learnt twice.
void PoseWrenchFilter::correct(const Innovation& now) noexcept {
  const WrenchFilter::Vector before = filter_.mean();
  filter_.correct();
  WrenchFilter::Vector change = filter_.mean() - before;
  const WrenchFilter::Wrenches off = now.H * change;  // the bias is no part of the prediction,
  for (int g = 0; g < filter_.grasp_count(); ++g) change.segment<6>(filter_.bias(g)).setZero();
  for (int g = 0, row = 0; g < filter_.grasp_count(); ++g) {
    if (!now.held[g]) continue;
    hands_[g].lagged += now.H.middleRows<6>(row) * change;
    row += 6;
  }
  if (at_rest_count_ == 0 || recent_.size() != off.size()) return;
  recent_ -= off;  // but of what is off
  if (!filter_.has_contact()) at_rest_ -= off;
}

void PoseWrenchFilter::judge_search(const elasticity::DeformationModel& model) noexcept {
  constexpr double kExplained = 0.8;
  constexpr double kClearlyBetter = 1;
  const ContactSearch::Found& found = search_.found();
  if (found.place < 0 || found.share < kExplained || found.force_O.isZero(0)) return;
  if (filter_.has_contact()) {
    if (found.place == place_ || found.cost + kClearlyBetter > search_.judge(place_, model).cost)
      return;
  }
  place_contact(found, model);
}

void PoseWrenchFilter::place_contact(const ContactSearch::Found& found,
                                     const elasticity::DeformationModel& model) noexcept {
  drop_contact(model);
  place_ = found.place;
  filter_.begin_contact(found.force_O, found.covariance);
  push(found.force_O, model);
  suspicions_ = 0;
  weak_for_ = 0;
}

void PoseWrenchFilter::drop_contact(const elasticity::DeformationModel& model) noexcept {
  if (!filter_.has_contact()) return;
  push(-filter_.mean().tail<3>(), model);
  filter_.end_contact();
  place_ = -1;
  unexplained_count_ = 0;
}

/// The prediction follows a change of the force at once.
void PoseWrenchFilter::push(const Eigen::Vector3d& force_O,
                            const elasticity::DeformationModel& model) noexcept {
  int row = 0;
  for (int g = 0; g < filter_.grasp_count(); ++g) {
    if (!model.is_held(g)) continue;
    const math::Vector6d wrench =
        ContactSearch::response(search_.place(place_).point, model.sensitivity(), g) * force_O;
    hands_[g].lagged += wrench;
    if (row + 6 <= recent_.size()) recent_.segment<6>(row) -= wrench;
    row += 6;
  }
}

void PoseWrenchFilter::judge_contact(const elasticity::DeformationModel& model,
                                     double dt) noexcept {
  if (!filter_.has_contact()) return;
  constexpr double kStandsOut = 3;  // deviations
  constexpr double kPatience = 0.3;
  const Eigen::Vector3d force = filter_.mean().tail<3>();
  const Eigen::Matrix3d P = filter_.covariance().bottomRightCorner<3, 3>();
  const bool weak = force.dot(P.ldlt().solve(force)) < kStandsOut * kStandsOut;
  weak_for_ = weak ? weak_for_ + dt : 0;
  if (weak_for_ < kPatience) return;
  drop_contact(model);
}

void PoseWrenchFilter::tell(const elasticity::DeformationModel& model, int grasps,
                            Estimate& estimate) noexcept {
  const WrenchFilter::Vector& mean = filter_.mean();
  for (int g = 0; g < grasps; ++g) {
    estimate.X_OG[g] = follower_.X_OG(g);
    estimate.reaction[g] = math::Wrench::from(stiffness() * model.reaction(g).vector());
    estimate.bias[g] = mean.segment<6>(filter_.bias(g));
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
  } else {
    contact = UnknownContact();
  }
  tell_nodes(model, grasps);
  estimate.node_deviation = &node_deviation_;
}

/// A tenth of the nodes a tick.
void PoseWrenchFilter::tell_nodes(const elasticity::DeformationModel& model, int grasps) noexcept {
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  if (!sensitivity.valid) return;
  constexpr int kMostColumns = 13;
  const int columns = filter_.log_young() + 1;  // offsets and log E come first
  std::array<math::Matrix6d, 2> turn;
  for (int g = 0; g < grasps; ++g) turn[g] = both_halves(follower_.X_OG(g).linear());
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostColumns> J(3, columns), JP(3, columns);
  const int nodes = static_cast<int>(node_deviation_.size());
  for (int i = 0; i < nodes / 10 + 1; ++i, next_node_ = (next_node_ + 1) % nodes) {
    J.setZero();
    for (int g = 0; g < grasps; ++g) {
      if (model.is_held(g))
        J.middleCols<6>(filter_.offset(g)).noalias() =
            sensitivity.dx_dxi[g].middleRows<3>(3 * next_node_) * turn[g];
    }
    J.col(columns - 1) = sensitivity.dx_dparameter.middleRows<3>(3 * next_node_)
                             .col(elasticity::Sensitivity::kLogYoung);
    JP.noalias() = J * filter_.covariance().topLeftCorner(columns, columns);
    const double variance = JP.cwiseProduct(J).sum() / 3;
    node_deviation_[static_cast<std::size_t>(next_node_)] =
        static_cast<float>(std::sqrt(std::max(0.0, variance)));
  }
}

}  // namespace palpate::estimation
