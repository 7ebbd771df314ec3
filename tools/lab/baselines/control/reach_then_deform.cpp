#include "tools/lab/baselines/control/reach_then_deform.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/control/control_law.hpp"
#include "tools/lab/baselines/control/feature_view.hpp"

namespace palpate::baselines {
namespace {

// Fraction of the region's radius within which it counts as reached.
constexpr double kInner = 0.5;
constexpr double kDamping = 0.1;  // relative to the norm of the Jacobian

}  // namespace

ReachThenDeform::ReachThenDeform(const Options& options, const shape::Feature& feature)
    : options_(options), dead_band_({options.dead_band, 0, 1.2}) {
  check_points(feature);
  for (const double value : {options.gain, options.linear_speed, options.hand_over,
                             options.softness, options.least_motion, options.touch})
    if (!(value > 0 && value < 1e3))
      throw std::invalid_argument("a number of reaching and deforming is out of range");
  if (!(options.update_gain > 0 && options.update_gain < 2))
    throw std::invalid_argument("the update's gain must lie in (0, 2)");
  if (options.region && !(options.region->radius > 0))
    throw std::invalid_argument("the region to be reached has no radius");
  const int rows = feature.dimension();
  points_ = std::max(1.0, rows / 3.0);
  J_.setZero(rows, 3);
  first_ = last_ = residual_ = Eigen::VectorXd::Zero(rows);
  ReachThenDeform::reset();
}

void ReachThenDeform::reset() noexcept {
  for (int row = 0; row < J_.rows(); ++row) J_.row(row) = Eigen::Vector3d::Unit(row % 3);
  begun_ = false;
  weight_ = options_.region ? 0 : 1;
  touching_ = !options_.region;
  dead_band_.reset();
}

Eigen::Vector3d ReachThenDeform::tip() const noexcept {
  return options_.region ? Eigen::Vector3d(X_OG_ * options_.region->tip_G)
                         : Eigen::Vector3d(X_OG_.translation());
}

void ReachThenDeform::observe(const control::Experience& now) noexcept {
  X_OG_ = now.X_OG;
  since_ += now.dt;
  const Eigen::VectorXd& value = *now.value;
  if (!begun_) {
    begun_ = true;
    first_ = last_ = value;
    last_tip_ = tip();
    since_ = 0;
    return;
  }
  if (options_.region &&
      (tip() - options_.region->place_O).norm() < kInner * options_.region->radius)
    weight_ = std::max(weight_, 1e-6);
  if (weight_ > 0) weight_ = std::min(1.0, weight_ + now.dt / options_.hand_over);
  if (!now.fresh || since_ < options_.period) return;
  // Without contact the points do not move, and there is nothing to learn.
  touching_ = touching_ || (value - first_).norm() > options_.touch * std::sqrt(points_);
  const Eigen::Vector3d motion = tip() - last_tip_;
  if (touching_ && weight_ > 0 && motion.norm() >= options_.least_motion) {
    const double square = options_.softness * options_.softness + motion.squaredNorm();
    residual_ = value - last_;
    residual_.noalias() -= J_.lazyProduct(motion);
    residual_ *= options_.update_gain / square;
    J_.noalias() += residual_.lazyProduct(motion.transpose());
  } else if (touching_ && weight_ > 0) {
    return;
  }
  last_ = value;
  last_tip_ = tip();
  since_ = 0;
}

bool ReachThenDeform::update(const shape::Feature&, const elasticity::DeformationModel&,
                             const math::Pose&, Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  J.setZero();
  J.leftCols<3>() = J_;
  return begun_ && J_.allFinite();
}

bool ReachThenDeform::commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept {
  V_O_G = math::Twist();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  if (options_.region && weight_ < 1) {
    const Eigen::Vector3d way = options_.region->place_O - tip();
    velocity = (1 - weight_) * options_.gain * way;
  }
  const Eigen::VectorXd& error = *inputs.error;
  const bool rests = dead_band_.rests(error.norm() / std::sqrt(points_), 0);
  if (weight_ > 0 && !rests) {
    Eigen::Matrix3d normal = J_.transpose().lazyProduct(J_);
    normal.diagonal().array() += kDamping * kDamping * normal.trace() + 1e-12;
    const Eigen::Vector3d pull = J_.transpose().lazyProduct(error);
    velocity += weight_ * options_.gain * (normal.inverse() * pull);
  }
  if (!velocity.allFinite()) return true;
  V_O_G.linear = control::factor_to_limit(velocity, options_.linear_speed) * velocity;
  return true;
}

}  // namespace palpate::baselines
