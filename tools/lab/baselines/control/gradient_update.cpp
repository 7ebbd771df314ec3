#include "tools/lab/baselines/control/gradient_update.hpp"

#include <stdexcept>

namespace palpate::baselines {

GradientUpdate::GradientUpdate(const Options& options) : options_(options) {
  if (!(options.gain > 0 && options.gain < 2))
    throw std::invalid_argument("the update's gain must lie in (0, 2)");
  if (!(options.softness >= 0 && options.softness < 1))
    throw std::invalid_argument("the update's softness must lie in [0, 1)");
}

void GradientUpdate::learn(const ScaledMotion& motion, const Eigen::VectorXd& change, bool probe,
                           Eigen::MatrixXd& J) noexcept {
  const double square = options_.softness * options_.softness + motion.squaredNorm();
  if (probe || !(square > 0)) return;
  residual_ = change;
  residual_.noalias() -= J.lazyProduct(motion);
  residual_ *= options_.gain / square;
  J.noalias() += residual_.lazyProduct(motion.transpose());
}

}  // namespace palpate::baselines
