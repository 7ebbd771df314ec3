#pragma once

#include "core/control/jacobian_providers.hpp"

namespace palpate::baselines {

/// Aghajanzadeh, Aranda, Corrales Ramon, Cariou, Lenain and Mezouar, "Adaptive deformation control
/// for elastic linear objects", Frontiers in Robotics and AI 9, 2022, and "An offline geometric
/// model for controlling the shape of elastic linear objects", IROS 2022: later than Table 2.2 in
/// Sanchez 2019.
///
/// Consumes: feature values (vision or estimate), an offline model, no probing motions. Kept: a
/// single Jacobian, computed offline about the rest shape, for the whole motion. Left out: their
/// geometric model of linear objects, replaced by the finite element sensitivity at rest, and the
/// online adaptation of its scale.
class ConstantJacobian final : public control::JacobianProvider {
 public:
  /// Throws as FemJacobian does.
  ConstantJacobian(const control::FemJacobian::Options& options, const shape::Feature& feature);

  /// False until the model has provided a sensitivity once; afterwards the Jacobian of that
  /// sensitivity.
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
  void reset() noexcept override { known_ = false; }

 private:
  control::FemJacobian fem_;
  Eigen::MatrixXd J_;
  bool known_ = false;
};

}  // namespace palpate::baselines
