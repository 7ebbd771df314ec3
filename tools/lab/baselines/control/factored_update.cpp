#include "tools/lab/baselines/control/factored_update.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::baselines {

FactoredUpdate::FactoredUpdate(double gain) : gain_(gain) {
  if (!(gain > 0 && gain <= 1)) throw std::invalid_argument("the update's gain must lie in (0, 1]");
}

void FactoredUpdate::resize(int rows) {
  image_.setZero(rows, 6);
  deformation_.setIdentity();
  residual_ = step_ = Eigen::VectorXd::Zero(rows);
  split_ = false;
}

/// Initial factorisation, which is not unique: B takes the relative norms of the columns of J, A
/// the scaled columns.
void FactoredUpdate::split(const Eigen::MatrixXd& J) noexcept {
  double largest = 0;
  for (int k = 0; k < 6; ++k) largest = std::max(largest, J.col(k).norm());
  if (!(largest > 0)) return;
  image_ = J;
  deformation_.setIdentity();
  for (int k = 0; k < 6; ++k) {
    const double size = std::max(J.col(k).norm() / largest, 1e-3);
    image_.col(k) /= size;
    deformation_(k, k) = size;
  }
  split_ = true;
}

void FactoredUpdate::learn(const ScaledMotion& motion, const Eigen::VectorXd& change, bool probe,
                           Eigen::MatrixXd& J) noexcept {
  const double square = motion.squaredNorm();
  if (probe || !(square > 0)) return;
  if (!split_) split(J);
  if (!split_) return;

  residual_ = change;
  residual_.noalias() -= J.lazyProduct(motion);
  residual_ *= 0.5 * gain_;
  const math::Vector6d between = deformation_ * motion;
  if (between.squaredNorm() > 0) {
    step_ = residual_ / between.squaredNorm();
    image_.noalias() += step_.lazyProduct(between.transpose());
  }
  // Change of the inner factor that best explains the remainder, along the steepest descent.
  const math::Vector6d down = image_.transpose().lazyProduct(residual_);
  step_.noalias() = image_.lazyProduct(down);
  const double curvature = step_.squaredNorm();
  if (curvature > 0) {
    const math::Vector6d middle = down * (down.squaredNorm() / curvature);
    deformation_.noalias() += middle * motion.transpose() / square;
  }
  J.noalias() = image_.lazyProduct(deformation_);
}

}  // namespace palpate::baselines
