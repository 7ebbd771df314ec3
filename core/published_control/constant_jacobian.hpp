#pragma once

#include "core/control/fem_jacobian.hpp"

namespace palpate::published_control {

/// Aghajanzadeh, Aranda, Corrales Ramon, Cariou, Lenain and Mezouar, "Adaptive deformation control
/// for elastic linear objects", Frontiers in Robotics and AI 9, 2022, and "An offline geometric
/// model for controlling the shape of elastic linear objects", IROS 2022: later work beside
/// Table 2.2.
///
/// Consumes: feature values (vision or estimate), a model off line, no probes. Kept: one Jacobian,
/// found off line about the rest shape, for the whole motion. Left out: their geometric model of
/// linear objects, in whose place the finite elements' sensitivity at rest comes, and the
/// adaptation of its scale on line.
class ConstantJacobian final : public control::JacobianProvider {
 public:
  /// Throws as FemJacobian does.
  ConstantJacobian(const control::FemJacobian::Options& options, const shape::Feature& feature);

  /// False until the model has had a sensitivity once; from then on that one's Jacobian.
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
  void reset() noexcept override { known_ = false; }

 private:
  control::FemJacobian fem_;
  Eigen::MatrixXd J_;
  bool known_ = false;
};

}  // namespace palpate::published_control
