// PoseWrenchFilter: innovation of the wrenches and its covariance.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/estimation/pose_wrench_filter.hpp"

namespace palpate::estimation {

WrenchFilter::Rows PoseWrenchFilter::wrench_rows(
    const std::array<bool, 2>& held, const elasticity::DeformationModel& model) const noexcept {
  const int rows = 6 * (static_cast<int>(held[0]) + static_cast<int>(held[1]));
  WrenchFilter::Rows H = WrenchFilter::Rows::Zero(rows, filter_.size());
  for (int g = 0, row = 0; g < filter_.grasp_count(); ++g) {
    if (!held[g]) continue;
    H.block(row, 0, 6, filter_.load()) =
        stiffness() * motion_.wrench_by_state().block(6 * g, 0, 6, filter_.load());
    H.block<6, 6>(row, filter_.bias(g)) = math::both_halves(follower_.X_OG(g).linear());
    if (filter_.has_contact())
      H.block<6, 3>(row, filter_.contact()) =
          ContactSearch::response(search_.place(place_).point, model.sensitivity(), motion_, g);
    row += 6;
  }
  return H;
}

/// Variance of a hand's predicted wrench from the state covariance. `H`: its six rows.
math::Vector6d PoseWrenchFilter::wrench_variance(int grasp, WrenchFilter::Rows H) const noexcept {
  H.middleCols<6>(filter_.bias(grasp)).setZero();
  WrenchFilter::Rows HP(H.rows(), H.cols());
  HP.noalias() = H * filter_.covariance();
  return HP.cwiseProduct(H).rowwise().sum().cwiseMax(0.0);
}

/// N, N m, magnitude of a hand's true wrench, to which the model error is proportional: combines
/// the predicted wrench, which may be too small by half, with the measured one and the uncertainty
/// of both. `H`, `y`: rows of the hand.
Eigen::Vector2d PoseWrenchFilter::size_of_wrench(int grasp, const WrenchFilter::Rows& H,
                                                 const math::Vector6d& y) const noexcept {
  const math::Vector6d& predicted = hands_[grasp].lagged;
  WrenchFilter::Rows without_bias = H;
  without_bias.middleCols<6>(filter_.bias(grasp)).setZero();
  WrenchFilter::Rows HP(H.rows(), H.cols());
  HP.noalias() = without_bias * filter_.covariance();
  const math::Matrix6d open = HP * without_bias.transpose();
  const math::Matrix6d measured = HP * H.transpose();
  HP.noalias() = H * filter_.covariance();
  math::Matrix6d S = HP * H.transpose();
  const double force = options_.force + options_.relative * predicted.head<3>().norm();
  const double torque =
      options_.torque + options_.relative * predicted.tail<3>().norm() + lever_[grasp] * force;
  S.diagonal().head<3>().array() += force * force;
  S.diagonal().tail<3>().array() += torque * torque;
  const math::Matrix6d gain = S.ldlt().solve(measured.transpose()).transpose();
  const math::Vector6d wrench = predicted + gain * y;
  const math::Vector6d left = (open - gain * measured.transpose()).diagonal().cwiseMax(0.0);
  return {std::sqrt(wrench.head<3>().squaredNorm() + left.head<3>().sum()),
          std::sqrt(wrench.tail<3>().squaredNorm() + left.tail<3>().sum())};
}

/// N, N m, standard deviation of the residual inertial wrench of an accelerating hand.
Eigen::Vector2d PoseWrenchFilter::inertial_error(const Hand& hand) const noexcept {
  constexpr double kReach = 0.2;  // m, from a grasp to the centre of mass of the hand
  const double force = options_.payload_error * (hand.acceleration.head<3>().norm() +
                                                 kReach * hand.acceleration.tail<3>().norm());
  return {force, kReach * force};
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
  result.H = wrench_rows(result.held, model);
  result.y = WrenchFilter::Wrenches::Zero(rows);
  result.R = WrenchFilter::Noise::Zero(rows, rows);
  result.measured = WrenchFilter::Wrenches::Zero(rows);
  for (int g = 0, row = 0; g < filter_.grasp_count(); ++g) {
    Hand& hand = hands_[g];
    if (!result.held[g]) continue;
    math::Vector6d late = math::Vector6d::Zero();  // change of the wrench within lag_deviation
    for (int other = 0; other < filter_.grasp_count(); ++other) {
      if (model.is_held(other))
        late += k * sensitivity.dw_dxi[g][other] * hands_[other].speed * options_.lag_deviation;
    }
    result.y.segment<6>(row) =
        hand.sum / hand.count -
        math::both_halves(follower_.X_OG(g).linear()) * filter_.mean().segment<6>(filter_.bias(g));
    const Eigen::Vector2d size =
        size_of_wrench(g, result.H.middleRows<6>(row), result.y.segment<6>(row));
    // All wrenches until the model error decorrelates carry the information of one.
    const double information =
        hand.information_gain * std::min(1.0, options_.period / kInformationTime);
    const double lasting = options_.relative / std::sqrt(std::max(information, 1e-9));
    const double force = lasting * size[0];
    const double torque = lasting * size[1] + lever_[g] * force;
    const Eigen::Vector2d inertial = inertial_error(hand);
    result.R.diagonal().segment<3>(row).setConstant(
        Eigen::Vector3d(options_.force, force, inertial[0]).squaredNorm());
    result.R.diagonal().segment<3>(row + 3).setConstant(
        Eigen::Vector3d(options_.torque, torque, inertial[1]).squaredNorm());
    result.R.block<6, 6>(row, row) += late * late.transpose();
    result.measured.segment<6>(row) = hand.sum_measured / hand.count;
    hand.sum.setZero();
    hand.sum_measured.setZero();
    hand.count = 0;
    row += 6;
  }
  return result;
}

/// Standard deviation of the predicted wrench: state covariance and model error.
void PoseWrenchFilter::find_reaction_deviation(const Innovation& now) noexcept {
  for (int g = 0, row = 0; g < filter_.grasp_count(); ++g) {
    if (!now.held[g]) continue;
    Hand& hand = hands_[g];
    const double force = options_.relative * hand.lagged.head<3>().norm();
    const double torque = options_.relative * hand.lagged.tail<3>().norm() + lever_[g] * force;
    math::Vector6d variance = wrench_variance(g, now.H.middleRows<6>(row));
    variance.head<3>().array() += force * force;
    variance.tail<3>().array() += torque * torque;
    hand.reaction_deviation = variance.cwiseSqrt();
    row += 6;
  }
}

}  // namespace palpate::estimation
