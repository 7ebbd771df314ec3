#pragma once

#include "core/control/control_law.hpp"

namespace palpate::control {

/// J = H dx/dxi: derivative of the feature with respect to the nodes times the deformation model's
/// static sensitivity of the nodes to the motion of the held grasp.
class FemJacobian : public JacobianProvider {
 public:
  struct Options {
    int grasp = 0;      // index of the moving grasp
    bool both = false;  // both grasps move: twelve columns
  };

  /// Throws std::invalid_argument if `grasp` is neither 0 nor 1.
  explicit FemJacobian(const Options& options);

  /// False while the model has no sensitivity or a moving grasp is not held.
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;

 private:
  bool fill(int grasp, const shape::Feature& feature, const elasticity::DeformationModel& model,
            Eigen::Ref<Eigen::MatrixXd> J) const noexcept;

  Options options_;
};

}  // namespace palpate::control
