#include "core/control/jacobian_providers.hpp"

#include "core/math/option_check.hpp"

namespace palpate::control {

FemJacobian::FemJacobian(const Options& options) : options_(options) {
  math::check_option(options.grasp >= 0 && options.grasp <= 1, "grasp", options.grasp, "0, 1");
}

bool FemJacobian::update(const shape::Feature& feature, const elasticity::DeformationModel& model,
                         const math::Pose& /*X_OG*/, Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  if (!options_.both) return fill(options_.grasp, feature, model, J);
  return fill(0, feature, model, J.leftCols(6)) && fill(1, feature, model, J.rightCols(6));
}

bool FemJacobian::fill(int grasp, const shape::Feature& feature,
                       const elasticity::DeformationModel& model,
                       Eigen::Ref<Eigen::MatrixXd> J) const noexcept {
  const elasticity::Sensitivity& sensitivity = model.sensitivity();
  const auto& dx_dxi = sensitivity.dx_dxi[grasp];
  if (!sensitivity.valid || !model.is_held(grasp) ||
      dx_dxi.rows() != 3 * model.positions().cols()) {
    return false;
  }
  accumulate_support(
      feature, [&](int node) { return dx_dxi.middleRows<3>(3 * node); }, J);
  return J.allFinite();
}

bool KinematicJacobian::update(const shape::Feature& feature,
                               const elasticity::DeformationModel& model, const math::Pose& X_OG,
                               Eigen::Ref<Eigen::MatrixXd> J) noexcept {
  const Eigen::Matrix3Xd& positions = model.positions();
  const Eigen::Vector3d p_OG = X_OG.translation();
  accumulate_support(
      feature,
      [&](int node) {
        const Eigen::Vector3d r = positions.col(node) - p_OG;
        Eigen::Matrix<double, 3, 6> motion;
        motion << Eigen::Matrix3d::Identity(), -math::cross_matrix(r);
        return motion;
      },
      J);
  return J.allFinite();
}

}  // namespace palpate::control
