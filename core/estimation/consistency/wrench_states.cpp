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

WrenchKnowledge::WrenchKnowledge(WrenchStates states, const Vector& deviations, double memory)
    : states_(states),
      mean_(Vector::Zero(states.count())),
      covariance_(deviations.cwiseAbs2().asDiagonal()),
      stationary_(deviations.cwiseAbs2()),
      memory_(memory) {}

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
  const int count = states_.count();
  const double time = std::max(record[0].time, record[1].time);
  Vector kept = Vector::Constant(count, std::exp((time_ - time) / memory_));
  time_ = time;
  for (int g = 0; g < states_.grasps; ++g) {
    const double with_pose = std::exp(travel_[g] - record[g].travel);
    travel_[g] = record[g].travel;
    kept.segment<6>(states_.pose_error(g)).setConstant(with_pose);
    kept.segment<6>(states_.wrench_error(g)).setConstant(with_pose);
  }
  mean_.head(count).array() *= kept.array();
  covariance_.topRows(count).array().colwise() *= kept.array();
  covariance_.leftCols(count).array().rowwise() *= kept.transpose().array();
  covariance_.diagonal().head(count).array() += (1 - kept.array().square()) * stationary_.array();
}

/// N, N m, of a hand for the nominal stiffness, by the displacements of all grasps and of
/// obstacles.
math::Vector6d WrenchKnowledge::by_displacements(const HandRecord& hand,
                                                 const Vector& mean) const noexcept {
  const int obstacle = states_.obstacle(), free = states_.free_directions;
  math::Vector6d wrench =
      hand.H.middleCols(obstacle, free).lazyProduct(mean.segment(obstacle, free));
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
  H.middleCols(states_.obstacle(), states_.free_directions) *= factor;
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

void WrenchKnowledge::assume(int first, const Vector& mean, const Vector& deviations) noexcept {
  const Eigen::Index size = mean.size();
  mean_.segment(first, size) = mean;
  covariance_.middleRows(first, size).setZero();
  covariance_.middleCols(first, size).setZero();
  covariance_.diagonal().segment(first, size) = deviations.cwiseAbs2();
}

void WrenchKnowledge::forget(int first) noexcept {
  assume(first, Vector::Zero(6), stationary_.segment<6>(first).cwiseSqrt());
}

void WrenchKnowledge::write(Vector& mean, Matrix& covariance) const noexcept {
  const int offsets = 6 * states_.grasps, free = states_.free_directions;
  Matrix select = Matrix::Zero(2 * offsets + 1 + free, mean_.size());
  select.leftCols(offsets).topRows(offsets).setIdentity();
  for (int g = 0; g < states_.grasps; ++g)
    select.block<6, 6>(states_.offset(g), states_.pose_error(g)).setIdentity();
  select(offsets, states_.log_young()) = 1;
  select.block(offsets + 1, states_.obstacle(), free, free).setIdentity();
  select.block(offsets + 1 + free, states_.bias(0), offsets, offsets).setIdentity();
  mean.noalias() = select * mean_;
  Matrix half(select.rows(), mean_.size());
  half.noalias() = select * covariance_;
  covariance.noalias() = half * select.transpose();
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
  J.middleCols(states_.obstacle(), states_.free_directions) =
      hand.H.middleCols(states_.obstacle(), states_.free_directions);
  JP.noalias() = J * covariance_;
  const math::Vector6d variance = JP.cwiseProduct(J).rowwise().sum().cwiseMax(0.0);
  const double force = std::sqrt(wrench.head<3>().squaredNorm() + variance.head<3>().sum());
  const double torque = std::sqrt(wrench.tail<3>().squaredNorm() + variance.tail<3>().sum());
  math::Vector6d size;
  size << Eigen::Vector3d::Constant(force), Eigen::Vector3d::Constant(torque + lever * force);
  return size;
}

}  // namespace palpate::estimation
