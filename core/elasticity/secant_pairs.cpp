#include "core/elasticity/secant_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::elasticity {

SecantPairs::SecantPairs(int unknowns) {
  for (Pair& pair : pairs_) {
    pair.step.setZero(4, unknowns);
    pair.change.setZero(4, unknowns);
  }
}

void SecantPairs::add(const Eigen::Matrix4Xd& step, const Eigen::Matrix4Xd& change) noexcept {
  const double curvature = dot(step, change);
  if (!(curvature > 1e-6 * std::sqrt(step.squaredNorm() * change.squaredNorm()))) return;
  Pair& pair = pairs_[next_];
  pair.step = step;
  pair.change = change;
  pair.scale = 1 / curvature;
  next_ = (next_ + 1) % kPairs;
  count_ = std::min(count_ + 1, kPairs);
}

}  // namespace palpate::elasticity
