#include "tools/lab/baselines/control/gaussian_process.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/control/control_law.hpp"
#include "tools/lab/baselines/control/feature_view.hpp"

namespace palpate::baselines {

GaussianProcess::GaussianProcess(const Options& options, const shape::Feature& feature)
    : options_(options), probes_(options.probes) {
  check_plain(feature);
  for (const double value : {options.least_motion, options.length, options.reach, options.noise,
                             options.gain, options.linear_speed, options.angular_speed})
    if (!(value > 0 && value < 1e3))
      throw std::invalid_argument("a number of the Gaussian process is out of range");
  if (options.samples < 6 || options.samples > kMostSamples)
    throw std::invalid_argument("the process keeps 6 to 80 samples");
  const int rows = feature.dimension();
  changes_.setZero(rows, kMostSamples);
  motions_.setZero();
  weights_.setZero();
  gram_ = factor_ = Eigen::MatrixXd::Zero(kMostSamples, kMostSamples);
  last_ = change_ = wish_ = Eigen::VectorXd::Zero(rows);
  points_ = std::max(1.0, rows / 3.0);
}

void GaussianProcess::reset() noexcept {
  probes_.restart();
  count_ = 0;
  begun_ = false;
}

double GaussianProcess::kernel(double square) const noexcept {
  const double length = options_.reach * size_;
  return std::exp(-0.5 * square / std::max(1e-18, length * length));
}

math::Vector6d GaussianProcess::motion_since(const math::Pose& X_OG) const noexcept {
  math::Vector6d motion;
  motion.head<3>() = X_OG.translation() - X_last_.translation();
  motion.tail<3>() =
      options_.length * math::log_rotation(X_OG.linear().lazyProduct(X_last_.linear().transpose()));
  return motion;
}

void GaussianProcess::add(const math::Vector6d& motion, const Eigen::VectorXd& change) noexcept {
  int at = count_;
  if (count_ == options_.samples) {
    at = 0;
    double nearest = (changes_.col(0) - change).squaredNorm();
    for (int i = 1; i < count_; ++i) {
      const double square = (changes_.col(i) - change).squaredNorm();
      if (square >= nearest) continue;
      nearest = square;
      at = i;
    }
  } else {
    ++count_;
  }
  changes_.col(at) = change;
  motions_.row(at) = motion.transpose();
  fit();
}

void GaussianProcess::fit() noexcept {
  size_ = motion_size_ = 0;
  for (int i = 0; i < count_; ++i) {
    size_ += changes_.col(i).norm() / count_;
    motion_size_ += motions_.row(i).norm() / count_;
  }
  // Targets are in units of their mean norm, so the prior's deviation is about 1. Without noise the
  // process would interpolate each sample and its mirror image exactly.
  const double noise = options_.noise * options_.noise;
  for (int j = 0; j < count_; ++j) {
    for (int i = j; i < count_; ++i)
      gram_(i, j) = kernel((changes_.col(i) - changes_.col(j)).squaredNorm());
    gram_(j, j) += noise;
  }
  // Cholesky factorisation and both substitutions in place, because Eigen's would allocate for this
  // size.
  for (int j = 0; j < count_; ++j) {
    double pivot = gram_(j, j);
    for (int k = 0; k < j; ++k) pivot -= factor_(j, k) * factor_(j, k);
    factor_(j, j) = std::sqrt(std::max(1e-12, pivot));
    for (int i = j + 1; i < count_; ++i) {
      double entry = gram_(i, j);
      for (int k = 0; k < j; ++k) entry -= factor_(i, k) * factor_(j, k);
      factor_(i, j) = entry / factor_(j, j);
    }
  }
  for (int i = 0; i < count_; ++i) {
    weights_.row(i) = motions_.row(i);
    for (int k = 0; k < i; ++k) weights_.row(i) -= factor_(i, k) * weights_.row(k);
    weights_.row(i) /= factor_(i, i);
  }
  for (int i = count_ - 1; i >= 0; --i) {
    for (int k = i + 1; k < count_; ++k) weights_.row(i) -= factor_(k, i) * weights_.row(k);
    weights_.row(i) /= factor_(i, i);
  }
}

math::Vector6d GaussianProcess::predict(const Eigen::VectorXd& change) noexcept {
  math::Vector6d motion = math::Vector6d::Zero();
  for (int i = 0; i < count_; ++i)
    motion += kernel((changes_.col(i) - change).squaredNorm()) * weights_.row(i).transpose();
  return motion;
}

void GaussianProcess::observe(const control::Experience& now) noexcept {
  since_ += now.dt;
  const bool first = !begun_;
  begun_ = true;
  const bool probed = !first && probes_.take_settled();
  if (!first && !probed && (!probes_.done() || !now.fresh || since_ < options_.period)) return;
  const math::Vector6d motion = motion_since(now.X_OG);
  if (!first && motion.norm() < options_.least_motion) return;
  if (!first) {
    change_ = *now.value - last_;
    add(motion, change_);
    // the mirrored sample is valid as well: a linear function is odd
    if (probed) {
      change_ = -change_;
      add(-motion, change_);
    }
  }
  last_ = *now.value;
  X_last_ = now.X_OG;
  since_ = 0;
}

bool GaussianProcess::commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept {
  if (!probes_.done()) {
    V_O_G = probes_.step(inputs.dt);
    return true;
  }
  const Eigen::VectorXd& error = *inputs.error;
  const double far = error.norm();
  V_O_G = math::Twist();
  if (!(far > options_.dead_band * std::sqrt(points_)) || !(size_ > 0)) return true;
  const double asked = std::min(far, 0.5 * size_);
  wish_ = error * (asked / far);
  math::Vector6d twist = predict(wish_) * (options_.gain * far / asked);
  twist.tail<3>() /= options_.length;
  V_O_G =
      control::limit_speed(math::Twist::from(twist), options_.linear_speed, options_.angular_speed);
  return true;
}

}  // namespace palpate::baselines
