#pragma once

#include "core/control/control_law.hpp"

namespace palpate::control {

/// Jacobian of a feature assumed to move rigidly with G: node i moves by [I, -[x_i - p_OG]x]. For a
/// point feature J = [I, -[r]x] with r from the origin of G to the point, for a pose [I, -[r]x; 0,
/// I]. Baseline without a mechanical model.
class KinematicJacobian : public JacobianProvider {
 public:
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
};

}  // namespace palpate::control
