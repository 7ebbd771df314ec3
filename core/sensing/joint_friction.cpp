#include "core/sensing/joint_friction.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/option_check.hpp"

namespace palpate::sensing {
namespace {

/// Rotation over which each element of equal weight goes from zero to its largest force, relative
/// to `presliding`: then the mean after a reversal is within 0.06 of Dahl's 1 - 2 exp(-x).
constexpr double kYield[] = {0.28, 0.66, 1.04, 1.95};
constexpr double kSame = 0.05;   // width of bounds that have met, over the Coulomb friction
constexpr double kCurve = 0.15;  // likewise, deviation of the build-up where it is half-way

}  // namespace

JointFriction::JointFriction(const Options& options)
    : options_(options), q_(Joints::Zero(options.coulomb.size())) {
  math::check_option(options.viscous.size() == options.coulomb.size(), "viscous",
                     options.viscous.size(), "as many values as coulomb");
  for (Eigen::Index i = 0; i < options.coulomb.size(); ++i) {
    math::check_not_negative(options.coulomb[i], "coulomb");
    math::check_not_negative(options.viscous[i], "viscous");
  }
  math::check_positive(options.presliding, "presliding");
  math::check_not_negative(options.error, "error");
  torque_.setZero(q_.size());
  deviation_.setZero(q_.size());
  reset();
}

void JointFriction::reset() noexcept {
  has_position_ = false;
  for (Elements& of_joint : elements_) {
    of_joint.lower.fill(-1);
    of_joint.upper.fill(1);
  }
  known_ = (options_.coulomb.array() == 0).all();
}

void JointFriction::follow(const Joints& q, const Joints& dq) noexcept {
  if (!has_position_) q_ = q;
  has_position_ = true;
  known_ = true;
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const double moved = (q[i] - q_[i]) / options_.presliding;
    auto& [lower, upper] = elements_[i];
    double share = 0, width = 0;
    for (int k = 0; k < kElements; ++k) {
      lower[k] = std::clamp(lower[k] + moved / kYield[k], -1.0, 1.0);
      upper[k] = std::clamp(upper[k] + moved / kYield[k], -1.0, 1.0);
      share += 0.5 * (lower[k] + upper[k]) / kElements;
      width += (upper[k] - lower[k]) / kElements;
    }
    const double coulomb = options_.coulomb[i], viscous = options_.viscous[i] * dq[i];
    torque_[i] = coulomb * share + viscous;
    const double sliding = options_.error * (coulomb * std::abs(share) + std::abs(viscous));
    const double uniform = coulomb * width / std::sqrt(12.0);
    const double curve = kCurve * coulomb * (1 - share * share);
    deviation_[i] = std::sqrt(sliding * sliding + uniform * uniform + curve * curve);
    known_ = known_ && (coulomb == 0 || width < kSame);
  }
  q_ = q;
}

}  // namespace palpate::sensing
