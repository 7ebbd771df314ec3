#include "core/frames/arm_frames.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::frames {

math::Wrench ArmFrames::wrench_in_object(const math::Wrench& F_S,
                                         const Eigen::Matrix3d& R_OG) const noexcept {
  const math::Pose X_GS = X_EG.inverse() * X_ES;
  return rotated(R_OG, math::transform(X_GS, F_S));
}

math::Twist ArmFrames::flange_twist(const math::Twist& V_O_G,
                                    const Eigen::Matrix3d& R_WE) const noexcept {
  const Eigen::Matrix3d& R_WO = X_WO.linear();
  const math::Twist V_W_G{R_WO * V_O_G.linear, R_WO * V_O_G.angular};
  const Eigen::Vector3d p_G_E_W = -(R_WE * X_EG.translation());
  return math::move_reference(V_W_G, p_G_E_W);
}

math::Twist ArmFrames::grasp_twist(const math::Twist& V_W_E,
                                   const Eigen::Matrix3d& R_WE) const noexcept {
  const Eigen::Vector3d p_E_G_W = R_WE * X_EG.translation();
  const Eigen::Matrix3d R_OW = X_WO.linear().transpose();
  return {R_OW * (V_W_E.linear + V_W_E.angular.cross(p_E_G_W)), R_OW * V_W_E.angular};
}

math::Wrench rotated(const Eigen::Matrix3d& R_AB, const math::Wrench& F_B) noexcept {
  return {R_AB * F_B.force, R_AB * F_B.torque};
}

bool are_near(const math::Pose& a, const math::Pose& b, double distance, double angle) noexcept {
  const double turned = std::sqrt(std::max(0.0, 3 - a.linear().cwiseProduct(b.linear()).sum()));
  return (a.translation() - b.translation()).norm() < distance && turned < angle;
}

}  // namespace palpate::frames
