#include "tools/lab/baselines/control/weighted_least_squares_update.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <stdexcept>

namespace palpate::baselines {

WeightedLeastSquaresUpdate::WeightedLeastSquaresUpdate(const Options& options) : options_(options) {
  if (options.window < 6 || options.window > 500)
    throw std::invalid_argument("the window must hold 6 to 500 motions");
  if (!(options.forgetting > 0 && options.forgetting <= 1))
    throw std::invalid_argument("forgetting must lie in (0, 1]");
  if (!(options.confidence > 0 && options.confidence < 1))
    throw std::invalid_argument("confidence must lie in (0, 1)");
}

void WeightedLeastSquaresUpdate::resize(int rows) {
  motions_.setZero(6, options_.window);
  changes_.setZero(rows, options_.window);
  mixed_.setZero(rows, 6);
  residual_.setZero(rows);
  forget();
}

void WeightedLeastSquaresUpdate::learn(const ScaledMotion& motion, const Eigen::VectorXd& change,
                                       bool probe, Eigen::MatrixXd& J) noexcept {
  motions_.col(next_) = motion;
  changes_.col(next_) = change;
  next_ = (next_ + 1) % options_.window;
  count_ = std::min(count_ + 1, options_.window);
  if (probe) return;

  math::Matrix6d normal = math::Matrix6d::Zero();
  mixed_.setZero();
  double weight = 1;
  for (int back = 1; back <= count_; ++back, weight *= options_.forgetting) {
    const int i = (next_ - back + options_.window) % options_.window;
    const ScaledMotion z = motions_.col(i);
    residual_ = changes_.col(i);
    residual_.noalias() -= J.lazyProduct(z);
    residual_ *= weight;
    normal.noalias() += weight * z.lazyProduct(z.transpose());
    mixed_.noalias() += residual_.lazyProduct(z.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<math::Matrix6d> solver(normal);
  if (solver.info() != Eigen::Success || !(solver.eigenvalues()[5] > 0)) return;
  for (int k = 0; k < 6; ++k) {
    const double eigenvalue = solver.eigenvalues()[k];
    if (!(eigenvalue > options_.confidence * solver.eigenvalues()[5])) continue;
    const ScaledMotion v = solver.eigenvectors().col(k);
    residual_.noalias() = mixed_.lazyProduct(v);
    residual_ /= eigenvalue;
    J.noalias() += residual_.lazyProduct(v.transpose());
  }
}

}  // namespace palpate::baselines
