#include "tools/lab/baselines/control/broyden_update.hpp"

#include <stdexcept>

namespace palpate::baselines {

BroydenUpdate::BroydenUpdate(double gain) : gain_(gain) {
  if (!(gain > 0 && gain <= 1)) throw std::invalid_argument("the update's gain must lie in (0, 1]");
}

void BroydenUpdate::learn(const ScaledMotion& motion, const Eigen::VectorXd& change, bool probe,
                          Eigen::MatrixXd& J) noexcept {
  const double square = motion.squaredNorm();
  if (probe || !(square > 0)) return;
  residual_ = change;
  residual_.noalias() -= J.lazyProduct(motion);
  residual_ *= gain_ / square;
  J.noalias() += residual_.lazyProduct(motion.transpose());
}

}  // namespace palpate::baselines
