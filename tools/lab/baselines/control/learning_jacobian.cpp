#include "tools/lab/baselines/control/learning_jacobian.hpp"

#include <Eigen/LU>
#include <stdexcept>
#include <utility>

namespace palpate::baselines {

LearningJacobian::LearningJacobian(const LearningOptions& options,
                                   std::unique_ptr<FeatureView> view,
                                   std::unique_ptr<JacobianUpdate> update,
                                   const shape::Feature& feature)
    : options_(options),
      view_(std::move(view)),
      update_(std::move(update)),
      probes_(options.probes) {
  if (!(options.period >= 0 && options.period < 10) ||
      !(options.least_motion > 0 && options.least_motion < 1) ||
      !(options.length > 0 && options.length < 10))
    throw std::invalid_argument("period, least motion or length of learning is out of range");
  view_->resize(feature);
  const int rows = view_->rows();
  update_->resize(rows);
  J_ = J_seen_ = probe_changes_ = Eigen::MatrixXd::Zero(rows, 6);
  probe_motions_.setIdentity();
  seen_ = last_ = change_ = Eigen::VectorXd::Zero(rows);
}

void LearningJacobian::reset() noexcept {
  probes_.restart();
  update_->forget();
  begun_ = known_ = false;
}

ScaledMotion LearningJacobian::motion_since(const math::Pose& X_OG) const noexcept {
  ScaledMotion motion;
  motion.head<3>() = X_OG.translation() - X_last_.translation();
  motion.tail<3>() =
      options_.length * math::log_rotation(X_OG.linear().lazyProduct(X_last_.linear().transpose()));
  return motion;
}

void LearningJacobian::take_probe(const math::Pose& X_OG) noexcept {
  const int probe = probes_.count() - 1;
  probe_motions_.col(probe) = motion_since(X_OG);
  change_ = seen_ - last_;
  probe_changes_.col(probe) = change_;
  update_->learn(probe_motions_.col(probe), change_, true, J_);
  last_ = seen_;
  X_last_ = X_OG;
  since_ = 0;
  if (!probes_.done()) return;
  const math::Matrix6d inverse = probe_motions_.inverse();
  known_ = inverse.allFinite();
  if (known_) J_.noalias() = probe_changes_.lazyProduct(inverse);
}

void LearningJacobian::observe(const control::Experience& now) noexcept {
  since_ += now.dt;
  view_->measure(*now.value, seen_);
  if (!begun_) {
    begun_ = true;
    last_ = seen_;
    X_last_ = now.X_OG;
    return;
  }
  if (probes_.take_settled()) return take_probe(now.X_OG);
  if (!known_ || !now.fresh || since_ < options_.period) return;
  const ScaledMotion motion = motion_since(now.X_OG);
  if (motion.norm() < options_.least_motion) return;
  change_ = seen_ - last_;
  update_->learn(motion, change_, false, J_);
  last_ = seen_;
  X_last_ = now.X_OG;
  since_ = 0;
}

bool LearningJacobian::update(const shape::Feature&, const elasticity::DeformationModel&,
                              const math::Pose&, Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  if (!known_) return false;
  J_seen_ = J_;
  J_seen_.rightCols<3>() *= options_.length;
  view_->express(J_seen_, J);
  return J.allFinite();
}

bool LearningJacobian::commands(const control::LawInputs& inputs, math::Twist& V_O_G) noexcept {
  if (probes_.done()) return false;
  V_O_G = probes_.step(inputs.dt);
  return true;
}

}  // namespace palpate::baselines
