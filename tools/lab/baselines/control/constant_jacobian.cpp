#include "tools/lab/baselines/control/constant_jacobian.hpp"

namespace palpate::baselines {

ConstantJacobian::ConstantJacobian(const control::FemJacobian::Options& options,
                                   const shape::Feature& feature)
    : fem_(options), J_(Eigen::MatrixXd::Zero(feature.dimension(), 6)) {}

bool ConstantJacobian::update(const shape::Feature& feature,
                              const elasticity::DeformationModel& model, const math::Pose& X_OG,
                              Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  if (!known_) known_ = fem_.update(feature, model, X_OG, J_);
  if (known_) J = J_;
  return known_;
}

}  // namespace palpate::baselines
