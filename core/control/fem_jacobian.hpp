#pragma once

#include "core/control/control_law.hpp"

namespace palpate::control {

/// J = H dx/dxi: the feature follows the nodes and these follow the held grasp as the deformation
/// model's static sensitivity says.
class FemJacobian : public JacobianProvider {
 public:
  struct Options {
    int grasp = 0;      // which grasp of the body moves
    bool both = false;  // both do: twelve columns
  };

  /// Throws std::invalid_argument where `grasp` is neither 0 nor 1.
  explicit FemJacobian(const Options& options);

  /// False while the model has no sensitivity or a grasp that moves is not held.
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;

 private:
  bool fill(int grasp, const shape::Feature& feature, const elasticity::DeformationModel& model,
            Eigen::Ref<Eigen::MatrixXd> J) const noexcept;

  Options options_;
};

}  // namespace palpate::control
