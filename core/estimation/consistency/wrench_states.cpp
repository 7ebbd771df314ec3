#include "core/estimation/consistency/wrench_states.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace palpate::estimation {
namespace {

constexpr double kForgotten = 1e3;  // decorrelation lengths that no knowledge of errors survives

}  // namespace

WrenchKnowledge::WrenchKnowledge(WrenchStates states, const Vector& deviations)
    : states_(states),
      mean_(Vector::Zero(states.count())),
      covariance_(deviations.cwiseAbs2().asDiagonal()) {
  travel_.fill(-kForgotten);
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
    const int first = states_.error(g);
    mean_.segment<6>(first) *= kept;
    covariance_.middleRows<6>(first) *= kept;
    covariance_.middleCols<6>(first) *= kept;
    covariance_.diagonal().segment<6>(first) += (1 - kept * kept) * record[g].error.cwiseAbs2();
    travel_[g] = record[g].travel;
  }
}

WrenchKnowledge::Comparison WrenchKnowledge::compare(const HandRecord::Rows& H,
                                                     const math::Vector6d& y,
                                                     const math::Matrix6d& R) const noexcept {
  Comparison result;
  result.difference = y - H * mean_;
  result.HP.noalias() = H * covariance_;
  result.S = R;
  result.S.noalias() += result.HP * H.transpose();
  const Eigen::LLT<math::Matrix6d> factor(result.S);
  result.valid = factor.info() == Eigen::Success && result.difference.allFinite();
  if (!result.valid) return result;
  const math::Vector6d whitened = factor.matrixL().solve(result.difference);
  result.squared = whitened.squaredNorm();
  result.log_likelihood = -0.5 * result.squared - factor.matrixLLT().diagonal().array().log().sum();
  return result;
}

void WrenchKnowledge::correct(const Comparison& comparison) noexcept {
  if (!comparison.valid) return;
  const Eigen::LLT<math::Matrix6d> factor(comparison.S);
  const HandRecord::Rows gain = factor.solve(comparison.HP);  // transposed
  mean_.noalias() += gain.transpose() * comparison.difference;
  covariance_.noalias() -= gain.transpose() * comparison.HP;
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

}  // namespace palpate::estimation
