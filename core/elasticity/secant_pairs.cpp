#include "core/elasticity/secant_pairs.hpp"

#include <algorithm>

namespace palpate::elasticity {

SecantPairs::SecantPairs(int size) {
  for (Pair& pair : pairs_) {
    pair.step.setZero(size);
    pair.change.setZero(size);
  }
}

void SecantPairs::add(const Eigen::VectorXf& step, const Eigen::VectorXf& change) noexcept {
  const float curvature = dot(step, change);
  if (!(curvature > 1e-5F * step.norm() * change.norm())) return;
  Pair& pair = pairs_[next_];
  pair.step = step;
  pair.change = change;
  pair.scale = 1 / curvature;
  next_ = (next_ + 1) % kPairs;
  count_ = std::min(count_ + 1, kPairs);
}

}  // namespace palpate::elasticity
