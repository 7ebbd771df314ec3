#include "core/estimation/consistency/wrench_states.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace palpate::estimation {
namespace {

constexpr double kMostLogYoung = 2;  // a factor of 7

double stiffness_factor(double log_young) noexcept {
  return std::exp(std::clamp(log_young, -kMostLogYoung, kMostLogYoung));
}

}  // namespace

WrenchKnowledge::WrenchKnowledge(WrenchStates states, const Vector& deviations)
    : states_(states),
      mean_(Vector::Zero(states.count())),
      covariance_(deviations.cwiseAbs2().asDiagonal()) {
  travel_.fill(0);
  varying_.setZero();
  for (int g = 0; g < states_.grasps; ++g) {
    varying_.col(g) << deviations.segment<6>(states_.pose_error(g)).cwiseAbs2(),
        deviations.segment<6>(states_.wrench_error(g)).cwiseAbs2();
  }
}

void WrenchKnowledge::append(const Matrix& covariance) noexcept {
  const Eigen::Index known = mean_.size(), added = covariance.rows();
  mean_.conservativeResize(known + added);
  mean_.tail(added).setZero();
  const Matrix before = covariance_;
  covariance_ = Matrix::Zero(known + added, known + added);
  covariance_.topLeftCorner(known, known) = before;
  covariance_.bottomRightCorner(added, added) = covariance;
}

void WrenchKnowledge::advance(const WrenchRecord& record) noexcept {
  for (int g = 0; g < states_.grasps; ++g) {
    const double kept = std::exp(travel_[g] - record[g].travel);
    travel_[g] = record[g].travel;
    if (kept == 1) continue;
    const auto fade = [&](int first, const math::Vector6d& variances) {
      mean_.segment<6>(first) *= kept;
      covariance_.middleRows<6>(first) *= kept;
      covariance_.middleCols<6>(first) *= kept;
      covariance_.diagonal().segment<6>(first) += (1 - kept * kept) * variances;
    };
    fade(states_.pose_error(g), varying_.col(g).head<6>());
    fade(states_.wrench_error(g), varying_.col(g).tail<6>());
  }
}

/// N, N m, of a hand for the nominal stiffness, by the displacements of all grasps.
math::Vector6d WrenchKnowledge::by_displacements(const HandRecord& hand,
                                                 const Vector& mean) const noexcept {
  math::Vector6d wrench = math::Vector6d::Zero();
  for (int g = 0; g < states_.grasps; ++g) {
    for (const int first : {states_.offset(g), states_.pose_error(g)})
      wrench += hand.H.middleCols<6>(first) * mean.segment<6>(first);
  }
  return wrench;
}

WrenchKnowledge::Linearised WrenchKnowledge::linearise(const HandRecord& hand,
                                                       const Appended& appended,
                                                       const Vector& mean) const noexcept {
  const int log_young = states_.log_young();
  const double factor = stiffness_factor(mean[log_young]);
  const math::Vector6d displaced = by_displacements(hand, mean),
                       elastic = hand.H.col(log_young) + displaced;
  Linearised result;
  HandRecord::Rows& H = result.H;
  H.resize(6, mean.size());
  H.leftCols(states_.count()) = hand.H;
  H.rightCols(appended.cols()) = appended;
  result.predicted =
      H * mean + (factor - 1) * displaced + (factor - 1 - mean[log_young]) * hand.H.col(log_young);
  for (int g = 0; g < states_.grasps; ++g) {
    for (const int first : {states_.offset(g), states_.pose_error(g)})
      H.middleCols<6>(first) *= factor;
  }
  H.col(log_young) = factor * elastic;
  const int stiffness = states_.stiffness(hand.grasp);
  H.middleCols<6>(stiffness).diagonal() = factor * elastic;
  result.predicted += factor * elastic.cwiseProduct(mean.segment<6>(stiffness));
  const int error = states_.wrench_error(hand.grasp);
  H.middleCols<6>(error).diagonal() = hand.size;
  result.predicted += hand.size.cwiseProduct(mean.segment<6>(error));
  return result;
}

WrenchKnowledge::Comparison WrenchKnowledge::compare(const HandRecord& hand,
                                                     const Appended& appended,
                                                     const math::Matrix6d& R) const noexcept {
  const Linearised model = linearise(hand, appended, mean_);
  Comparison result;
  result.difference = hand.y - model.predicted;
  result.HP.noalias() = model.H * covariance_;
  result.S = R;
  result.S.noalias() += result.HP * model.H.transpose();
  const Eigen::LLT<math::Matrix6d> factor(result.S);
  result.valid = factor.info() == Eigen::Success && result.difference.allFinite();
  if (!result.valid) return result;
  const math::Vector6d whitened = factor.matrixL().solve(result.difference);
  result.squared = whitened.squaredNorm();
  result.log_likelihood = -0.5 * result.squared - factor.matrixLLT().diagonal().array().log().sum();
  return result;
}

void WrenchKnowledge::correct(const HandRecord& hand, const Appended& appended,
                              const math::Matrix6d& R) noexcept {
  constexpr int kIterations = 2;  // of Gauss and Newton: the iterated extended Kalman filter
  Vector mean = mean_;
  HandRecord::Rows HP, gain;  // gain: transposed
  for (int i = 0; i < kIterations; ++i) {
    const Linearised model = linearise(hand, appended, mean);
    HP.noalias() = model.H * covariance_;
    math::Matrix6d S = R;
    S.noalias() += HP * model.H.transpose();
    const Eigen::LLT<math::Matrix6d> factor(S);
    const math::Vector6d difference = hand.y - model.predicted - model.H * (mean_ - mean);
    if (factor.info() != Eigen::Success || !difference.allFinite()) return;
    gain = factor.solve(HP);
    mean = mean_;
    mean.noalias() += gain.transpose() * difference;
  }
  mean_ = mean;
  covariance_.noalias() -= gain.transpose() * HP;
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
}

void WrenchKnowledge::diffuse(int first, const Matrix& covariance) noexcept {
  covariance_.block(states_.count() + first, states_.count() + first, covariance.rows(),
                    covariance.cols()) += covariance;
}

WrenchKnowledge WrenchKnowledge::folded(int into) const noexcept {
  const int count = states_.count();
  Matrix sums = Matrix::Identity(count, mean_.size());
  sums.block<6, 6>(into, count).setIdentity();
  WrenchKnowledge result = *this;
  result.mean_ = (sums * mean_).eval();
  result.covariance_ = (sums * covariance_ * sums.transpose()).eval();
  return result;
}

math::Vector6d WrenchKnowledge::size_of_wrench(const HandRecord& hand,
                                               const math::Vector6d& nominal,
                                               double lever) const noexcept {
  const double factor = stiffness_factor(mean_[states_.log_young()]);
  const math::Vector6d wrench =
      nominal + factor * by_displacements(hand, mean_) +
      (factor - 1) * hand.H.col(states_.log_young()) +
      hand.H.middleCols<2>(states_.log_young() + 1) * mean_.segment<2>(states_.log_young() + 1);
  HandRecord::Rows J = HandRecord::Rows::Zero(6, mean_.size()), JP(6, mean_.size());
  for (int g = 0; g < states_.grasps; ++g) {
    for (const int first : {states_.offset(g), states_.pose_error(g)})
      J.middleCols<6>(first) = hand.H.middleCols<6>(first);
  }
  JP.noalias() = J * covariance_;
  const math::Vector6d variance = JP.cwiseProduct(J).rowwise().sum().cwiseMax(0.0);
  const double force = std::sqrt(wrench.head<3>().squaredNorm() + variance.head<3>().sum());
  const double torque = std::sqrt(wrench.tail<3>().squaredNorm() + variance.tail<3>().sum());
  math::Vector6d size;
  size << Eigen::Vector3d::Constant(force), Eigen::Vector3d::Constant(torque + lever * force);
  return size;
}

}  // namespace palpate::estimation
