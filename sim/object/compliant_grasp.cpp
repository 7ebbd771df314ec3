#include "sim/object/compliant_grasp.hpp"

#include <stdexcept>

namespace palpate::object {

CompliantGrasp::CompliantGrasp(const HexahedralGrid& grid, const Box& patch, double stiffness,
                               double damping) {
  if (!(stiffness > 0) || !(damping >= 0)) {
    throw std::invalid_argument("plant: needs pad_stiffness > 0 and pad_damping >= 0");
  }
  const Eigen::VectorXd areas = grid.patch_areas(patch);
  const double total = areas.sum();
  if (!(total > 0)) throw std::invalid_argument("plant: the grasp box holds no surface node");
  for (int n = 0; n < areas.size(); ++n) {
    if (areas[n] <= 0) continue;
    Pad pad;
    pad.node = n;
    pad.stiffness = stiffness * areas[n] / total;
    pad.damping = damping * areas[n] / total;
    pads_.push_back(pad);
  }
}

void CompliantGrasp::attach(const math::Pose& X_OG, const Eigen::Matrix3Xd& positions) noexcept {
  const math::Pose X_GO = X_OG.inverse();
  for (Pad& pad : pads_) pad.p_G = X_GO * Eigen::Vector3d(positions.col(pad.node));
}

void CompliantGrasp::move(const math::Pose& X_OG, const math::Twist& V_O_G) noexcept {
  p_OG_ = X_OG.translation();
  for (Pad& pad : pads_) {
    pad.p_O = X_OG * pad.p_G;
    pad.velocity_O = V_O_G.linear + V_O_G.angular.cross(pad.p_O - p_OG_);
  }
}

math::Wrench CompliantGrasp::wrench(const Eigen::Matrix3Xd& positions,
                                    const Eigen::Matrix3Xd& velocities) const noexcept {
  math::Wrench total;
  for (const Pad& pad : pads_) {
    const Eigen::Vector3d force = pad.stiffness * (pad.p_O - positions.col(pad.node)) +
                                  pad.damping * (pad.velocity_O - velocities.col(pad.node));
    total.force += force;
    total.torque += (positions.col(pad.node) - p_OG_).cross(force);
  }
  return total;
}

}  // namespace palpate::object
