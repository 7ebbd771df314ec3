#include "core/estimation/wrench_update.hpp"

#include <Eigen/Cholesky>

namespace palpate::estimation {
namespace {

constexpr double kInformationTime = 0.2;  // s, time over which new information is absorbed

/// Variance of a hand's predicted wrench from the state covariance. `H`: its six rows.
math::Vector6d wrench_variance(int grasp, WrenchFilter::Rows H,
                               const WrenchFilter& filter) noexcept {
  H.middleCols<6>(filter.bias(grasp)).setZero();
  WrenchFilter::Rows HP(H.rows(), H.cols());
  HP.noalias() = H * filter.covariance();
  return HP.cwiseProduct(H).rowwise().sum().cwiseMax(0.0);
}

}  // namespace

WrenchUpdate::WrenchUpdate(const elasticity::Body& body, const Options& options)
    : options_(options), baseline_(options) {
  const Eigen::Vector3d middle = body.mesh.nodes.rowwise().mean();
  for (std::size_t g = 0; g < body.grasps.size(); ++g)
    lever_[g] = (body.grasps[g].X_OG_rest.translation() - middle).norm();
}

void WrenchUpdate::reset() noexcept {
  hands_.fill(Hand());
  since_update_ = 0;
  innovation_test_ = -1;
  baseline_.forget();
}

bool WrenchUpdate::is_due(double dt) noexcept {
  since_update_ += dt;
  if (since_update_ < options_.period * (1 - 1e-9)) return false;
  since_update_ = 0;
  return true;
}

double WrenchUpdate::absorbed() const noexcept {
  return std::min(1.0, options_.period / kInformationTime);
}

void WrenchUpdate::predict(int grasp, const math::Vector6d& wrench, const math::Pose& X_OG,
                           const GraspInput& input, double dt) noexcept {
  Hand& hand = hands_[grasp];
  if (!hand.known) {
    hand.known = true;
    hand.lagged = wrench;
    hand.X_OG_before = X_OG;
  }
  math::Vector6d speed;
  speed << (X_OG.translation() - hand.X_OG_before.translation()) / dt,
      math::log_rotation(X_OG.linear() * hand.X_OG_before.linear().transpose()) / dt;
  hand.X_OG_before = X_OG;
  const double travel =
      dt * (speed.head<3>().norm() / options_.decorrelation_distance +
            speed.tail<3>().norm() / options_.decorrelation_angle + 1 / options_.correlation);
  hand.travel += travel;
  hand.information_gain = std::min(1.0, hand.information_gain + travel);
  const double share = 1 - std::exp(-dt / options_.lag);
  hand.lagged += share * (wrench - hand.lagged);
  const math::Vector6d faster = share * (speed - hand.speed);
  hand.speed += faster;
  constexpr double kRecent = 0.05;  // s
  hand.acceleration += std::min(1.0, dt / kRecent) * (faster / dt - hand.acceleration);
  if (!input.wrench_valid) return;
  const math::Vector6d measured = input.F_G_O.vector();
  if (!measured.allFinite()) return;
  hand.covariance = input.covariance;
  hand.sum += measured - hand.lagged;
  hand.sum_measured += measured;
  ++hand.count;
}

/// N, N m, magnitude of a hand's true wrench, to which the model error is proportional: combines
/// the predicted wrench, which may be too small by half, with the measured one and the uncertainty
/// of both. `H`, `y`: rows of the hand.
Eigen::Vector2d WrenchUpdate::size_of_wrench(int grasp, const WrenchFilter::Rows& H,
                                             const math::Vector6d& y,
                                             const WrenchFilter& filter) const noexcept {
  const math::Vector6d& predicted = hands_[grasp].lagged;
  WrenchFilter::Rows without_bias = H;
  without_bias.middleCols<6>(filter.bias(grasp)).setZero();
  WrenchFilter::Rows HP(H.rows(), H.cols());
  HP.noalias() = without_bias * filter.covariance();
  const math::Matrix6d open = HP * without_bias.transpose();
  const math::Matrix6d measured = HP * H.transpose();
  HP.noalias() = H * filter.covariance();
  math::Matrix6d S = HP * H.transpose();
  const double force = options_.force + options_.relative * predicted.head<3>().norm();
  const double torque =
      options_.torque + options_.relative * predicted.tail<3>().norm() + lever_[grasp] * force;
  S += hands_[grasp].covariance;
  S.diagonal().head<3>().array() += force * force;
  S.diagonal().tail<3>().array() += torque * torque;
  const math::Matrix6d gain = S.ldlt().solve(measured.transpose()).transpose();
  const math::Vector6d wrench = predicted + gain * y;
  const math::Vector6d left = (open - gain * measured.transpose()).diagonal().cwiseMax(0.0);
  return {std::sqrt(wrench.head<3>().squaredNorm() + left.head<3>().sum()),
          std::sqrt(wrench.tail<3>().squaredNorm() + left.tail<3>().sum())};
}

/// N, N m, standard deviation of the residual inertial wrench of an accelerating hand.
Eigen::Vector2d WrenchUpdate::inertial_error(const Hand& hand) const noexcept {
  constexpr double kReach = 0.2;  // m, from a grasp to the centre of mass of the hand
  const double force = options_.payload_error * (hand.acceleration.head<3>().norm() +
                                                 kReach * hand.acceleration.tail<3>().norm());
  return {force, kReach * force};
}

/// Covariance of the noise of a hand's rows. `late`: change of its wrench within lag_deviation.
void WrenchUpdate::add_noise(int grasp, int row, const math::Vector6d& late,
                             const FusedState& state, Innovation& innovation) const noexcept {
  const Hand& hand = hands_[grasp];
  const Eigen::Vector2d size = size_of_wrench(grasp, innovation.H.middleRows<6>(row),
                                              innovation.y.segment<6>(row), state.filter);
  // All wrenches until the errors of model and sensor decorrelate carry the information of one.
  const double information = hand.information_gain * absorbed();
  const double lasting = options_.relative / std::sqrt(std::max(information, 1e-9));
  const double force = lasting * size[0];
  const double torque = lasting * size[1] + lever_[grasp] * force;
  const Eigen::Vector2d inertial = inertial_error(hand);
  innovation.R.diagonal().segment<3>(row).setConstant(
      Eigen::Vector3d(options_.force, force, inertial[0]).squaredNorm());
  innovation.R.diagonal().segment<3>(row + 3).setConstant(
      Eigen::Vector3d(options_.torque, torque, inertial[1]).squaredNorm());
  innovation.R.block<6, 6>(row, row) +=
      late * late.transpose() + hand.covariance / std::max(information, 1e-9);
  innovation.noise.diagonal().segment<3>(row).setConstant(
      Eigen::Vector2d(options_.force, inertial[0]).squaredNorm());
  innovation.noise.diagonal().segment<3>(row + 3).setConstant(
      Eigen::Vector2d(options_.torque, inertial[1]).squaredNorm());
  innovation.noise.block<6, 6>(row, row) += late * late.transpose() + hand.covariance;
}

Innovation WrenchUpdate::take_innovation(const FusedState& state,
                                         const elasticity::DeformationModel& model) noexcept {
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  const WrenchFilter& filter = state.filter;
  const double k = state.stiffness();
  Innovation result;
  int rows = 0;
  for (int g = 0; g < filter.grasp_count(); ++g) {
    result.held[g] = sensitivity.valid && model.is_held(g) && hands_[g].count > 0;
    rows += result.held[g] ? 6 : 0;
  }
  result.H = state.wrench_rows(result.held, model);
  result.y = WrenchFilter::Wrenches::Zero(rows);
  result.R = result.noise = WrenchFilter::Noise::Zero(rows, rows);
  result.measured = WrenchFilter::Wrenches::Zero(rows);
  for (int g = 0, row = 0; g < filter.grasp_count(); ++g) {
    Hand& hand = hands_[g];
    result.travel[g] = hand.travel;
    hand.travel = 0;
    if (!result.held[g]) continue;
    math::Vector6d late = math::Vector6d::Zero();
    for (int other = 0; other < filter.grasp_count(); ++other) {
      if (model.is_held(other))
        late += k * sensitivity.dw_dxi[g][other] * hands_[other].speed * options_.lag_deviation;
    }
    result.y.segment<6>(row) = hand.sum / hand.count - math::both_halves(state.X_OG[g].linear()) *
                                                           filter.mean().segment<6>(filter.bias(g));
    add_noise(g, row, late, state, result);
    result.measured.segment<6>(row) = hand.sum_measured / hand.count;
    hand.sum.setZero();
    hand.sum_measured.setZero();
    hand.count = 0;
    row += 6;
  }
  find_reaction_deviations(result, filter);
  return result;
}

/// Standard deviation of the predicted wrench: state covariance and model error.
void WrenchUpdate::find_reaction_deviations(const Innovation& now,
                                            const WrenchFilter& filter) noexcept {
  for (int g = 0, row = 0; g < filter.grasp_count(); ++g) {
    if (!now.held[g]) continue;
    Hand& hand = hands_[g];
    const double force = options_.relative * hand.lagged.head<3>().norm();
    const double torque = options_.relative * hand.lagged.tail<3>().norm() + lever_[g] * force;
    math::Vector6d variance = wrench_variance(g, now.H.middleRows<6>(row), filter);
    variance.head<3>().array() += force * force;
    variance.tail<3>().array() += torque * torque;
    hand.reaction_deviation = variance.cwiseSqrt();
    row += 6;
  }
}

double WrenchUpdate::test(const Innovation& innovation, FusedState& state) noexcept {
  const double test = state.filter.test(innovation.H, innovation.y, innovation.R);
  innovation_test_ = test / innovation.rows();
  return test;
}

bool WrenchUpdate::passes(const Innovation& innovation, FusedState& state) const noexcept {
  return state.filter.test(innovation.H, innovation.y, innovation.R) <=
         options_.gate / kHandRows * innovation.rows();
}

void WrenchUpdate::correct(const Innovation& now, FusedState& state) noexcept {
  const WrenchFilter::Vector before = state.filter.mean();
  state.filter.correct();
  absorb(now);
  follow(now.held, now.H, state.filter.mean() - before, state);
}

void WrenchUpdate::absorb(const Innovation& now) noexcept {
  for (std::size_t g = 0; g < hands_.size(); ++g)
    if (now.held[g]) hands_[g].information_gain *= 1 - absorbed();
}

void WrenchUpdate::follow(const std::array<bool, 2>& held, const WrenchFilter::Rows& H,
                          WrenchFilter::Vector change, const FusedState& state) noexcept {
  const WrenchFilter& filter = state.filter;
  const WrenchFilter::Wrenches off = H * change;  // the bias is part of the innovation,
  for (int g = 0; g < filter.grasp_count(); ++g) change.segment<6>(filter.bias(g)).setZero();
  for (int g = 0, row = 0; g < filter.grasp_count(); ++g) {
    if (!held[g]) continue;
    hands_[g].lagged += H.middleRows<6>(row) * change;  // but not of the prediction
    row += 6;
  }
  baseline_.follow(off, filter.has_contact());
}

void WrenchUpdate::follow_contact(const Eigen::Vector3d& force_O, const FusedState& state,
                                  const elasticity::DeformationModel& model) noexcept {
  for (int g = 0; g < state.filter.grasp_count(); ++g) {
    if (!model.is_held(g)) continue;
    const math::Vector6d wrench = state.contact_response(g, model) * force_O;
    hands_[g].lagged += wrench;
    hands_[g].sum -= hands_[g].count * wrench;
    baseline_.follow_contact(g, wrench);
  }
  baseline_.restart_recent();
}

}  // namespace palpate::estimation
