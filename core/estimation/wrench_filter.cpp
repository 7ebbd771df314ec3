#include "core/estimation/wrench_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::estimation {

WrenchFilter::WrenchFilter(int grasps, const Options& options)
    : grasps_(grasps), free_(static_cast<int>(options.obstacles.size())), options_(options) {
  math::check_option(grasps >= 1 && grasps <= 2, "grasps", grasps, "1, 2");
  math::check_positive_finite(options.position, "position");
  math::check_positive_finite(options.rotation, "rotation");
  math::check_positive_finite(options.log_young, "log_young");
  math::check_positive_finite(options.bias_force, "bias_force");
  math::check_positive_finite(options.bias_torque, "bias_torque");
  math::check_positive_finite(options.memory, "memory");
  math::check_positive_finite(options.load_memory, "load_memory");
  math::check_option(free_ <= collision::kMostFreeDirections, "obstacles", free_,
                     "at most " + std::to_string(collision::kMostFreeDirections));
  for (const collision::FreeDirection& direction : options.obstacles)
    math::check_positive_finite(direction.deviation, "obstacles");
  prior_ = Vector::Zero(size());
  for (int g = 0; g < grasps; ++g) {
    prior_.segment<3>(offset(g)).setConstant(options.position * options.position);
    prior_.segment<3>(offset(g) + 3).setConstant(options.rotation * options.rotation);
    prior_.segment<3>(bias(g)).setConstant(options.bias_force * options.bias_force);
    prior_.segment<3>(bias(g) + 3).setConstant(options.bias_torque * options.bias_torque);
  }
  prior_[log_young()] = options.log_young * options.log_young;
  for (int k = 0; k < free_; ++k)
    prior_[obstacle() + k] = std::pow(options.obstacles[static_cast<std::size_t>(k)].deviation, 2);
  reset();
}

void WrenchFilter::reset() noexcept {
  mean_ = Vector::Zero(size());
  P_ = Covariance::Zero(size(), size());
  prior_.segment<kLoads>(load()).setZero();
  P_.diagonal() = prior_;
  has_loads_ = has_contact_ = false;
}

void WrenchFilter::predict(double dt) noexcept {
  const double kept = std::exp(-dt / options_.memory);
  const int steady = contact();  // stationary states; the contact's force follows
  mean_.head(steady) *= kept;
  P_.topRows(steady) *= kept;
  P_.leftCols(steady) *= kept;
  P_.diagonal().head(steady) += (1 - kept * kept) * prior_.head(steady);
  P_.diagonal().segment<kLoads>(load()) +=
      2 * dt / options_.load_memory * prior_.segment<kLoads>(load());
  constexpr double kWander = 0.01;  // 1/s, as a fraction of the prior's variance
  if (has_contact_) P_.bottomRightCorner<3, 3>() += kWander * dt * contact_prior_;
}

double WrenchFilter::test(const Rows& H, const Wrenches& y, const Noise& R) noexcept {
  if (!H.allFinite() || !y.allFinite() || !R.allFinite()) return -1;
  H_ = H;
  y_ = y;
  R_ = R;
  Rows HP = Rows::Zero(H.rows(), H.cols());
  HP.noalias() = H * P_;
  S_ = R;
  S_.noalias() += HP * H.transpose();
  const Eigen::LLT<Noise> factor(S_);
  if (factor.info() != Eigen::Success) return -1;
  Wrenches whitened = y;
  factor.matrixL().solveInPlace(whitened);
  return whitened.squaredNorm();
}

void WrenchFilter::correct() noexcept {
  const int rows = static_cast<int>(H_.rows());
  Rows gain_transposed = Rows::Zero(rows, size());
  gain_transposed.noalias() = H_ * P_;
  const Eigen::LLT<Noise> factor(S_);
  factor.solveInPlace(gain_transposed);
  if (has_contact_) gain_transposed.leftCols(contact()).setZero();
  mean_.noalias() += gain_transposed.transpose() * y_;
  // the Joseph form keeps the covariance symmetric and positive semi-definite despite rounding
  Covariance keep = Covariance::Identity(size(), size());
  keep.noalias() -= gain_transposed.transpose() * H_;
  Covariance half = Covariance::Zero(size(), size());
  half.noalias() = keep * P_;
  P_.noalias() = half * keep.transpose();
  Rows noisy = Rows::Zero(rows, size());
  noisy.noalias() = R_ * gain_transposed;
  P_.noalias() += gain_transposed.transpose() * noisy;
}

void WrenchFilter::begin_loads(const math::Vector6d& deviation) noexcept {
  if (has_loads_ || !deviation.allFinite()) return;
  has_loads_ = true;
  prior_.segment<kLoads>(load()) = deviation.cwiseAbs2();
  P_.diagonal().segment<kLoads>(load()) = deviation.cwiseAbs2();
}

bool WrenchFilter::take(const ShapeMatrix& A, const ShapeState& b) noexcept {
  const int n = shape_size();
  if (A.rows() != n || b.size() != n || !A.allFinite() || !b.allFinite()) return false;
  // P+ = P (I + A P)^-1 needs no inverse of P, which is singular if a state is known exactly.
  ShapeMatrix whole = ShapeMatrix::Identity(n, n);
  whole.noalias() += P_.topLeftCorner(n, n) * A;
  Covariance gain_transposed = P_.topRows(n);
  gain_transposed = Eigen::PartialPivLU<ShapeMatrix>(whole).solve(gain_transposed);
  if (!gain_transposed.allFinite()) return false;
  if (has_contact_) gain_transposed.rightCols<3>().setZero();
  ShapeState y = b;
  y.noalias() -= A * mean_.head(n);
  mean_.noalias() += gain_transposed.transpose() * y;
  Covariance keep = Covariance::Identity(size(), size());
  Covariance AK = Covariance::Zero(n, size());
  AK.noalias() = A * gain_transposed;
  keep.leftCols(n) -= AK.transpose();
  Covariance half = Covariance::Zero(size(), size());
  half.noalias() = keep * P_;
  P_.noalias() = half * keep.transpose();
  P_.noalias() += gain_transposed.transpose() * AK;
  return true;
}

void WrenchFilter::begin_contact(const Eigen::Vector3d& force_O,
                                 const Eigen::Matrix3d& covariance) noexcept {
  end_contact();
  has_contact_ = true;
  mean_.tail<3>() = force_O;
  contact_prior_ = covariance;
  P_.bottomRightCorner<3, 3>() = covariance;
}

void WrenchFilter::end_contact() noexcept {
  has_contact_ = false;
  mean_.tail<3>().setZero();
  P_.bottomRows<3>().setZero();
  P_.rightCols<3>().setZero();
}

void WrenchFilter::assume(const Vector& mean, const Covariance& covariance) noexcept {
  const int known = load(), biases = 6 * grasps_;
  mean_.head(known) = mean.head(known);
  mean_.segment(bias(0), biases) = mean.tail(biases);
  P_.topLeftCorner(known, known) = covariance.topLeftCorner(known, known);
  P_.block(0, bias(0), known, biases) = covariance.topRightCorner(known, biases);
  P_.block(bias(0), 0, biases, known) = covariance.bottomLeftCorner(biases, known);
  P_.block(bias(0), bias(0), biases, biases) = covariance.bottomRightCorner(biases, biases);
}

double WrenchFilter::deviation(int state) const noexcept {
  return std::sqrt(std::max(0.0, P_(state, state)));
}

bool WrenchFilter::is_observed(int state) const noexcept {
  constexpr double kShare = 0.8;
  return state >= contact() ? has_contact_ : P_(state, state) < kShare * prior_[state];
}

}  // namespace palpate::estimation
