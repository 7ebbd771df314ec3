#include "core/control/kinematic_jacobian.hpp"

#include "core/control/support_motion.hpp"

namespace palpate::control {

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
