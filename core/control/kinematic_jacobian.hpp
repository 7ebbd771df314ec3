#pragma once

#include "core/control/control_law.hpp"

namespace palpate::control {

/// The feature taken to move rigidly with G: node i by [I, -[x_i - p_OG]x]. A point feature gets
/// J = [I, -[r]x] with r from the origin of G to it, a pose [I, -[r]x; 0, I]. The baseline that
/// knows no mechanics.
class KinematicJacobian : public JacobianProvider {
 public:
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
};

}  // namespace palpate::control
