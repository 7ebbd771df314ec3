#pragma once

#include "core/elasticity/body_system.hpp"
#include "core/elasticity/deformation_model.hpp"

namespace palpate::elasticity {

struct Thesis2018Options {
  double time_step = 0.02;  // s
};

/// Integrator of the thesis software of 2018 (Sanchez 2019; Vega FEM's co-rotational tetrahedra,
/// "warp 1"), to reproduce its results: linear tetrahedra, warped stiffness R K R^T, consistent
/// mass, Rayleigh damping, implicit Euler with one Newton step,
///   (M + h D + h^2 K) dv = h [f_ext - f_int - (D + h K) v],  v += dv,  x += h v.
/// As in the original, every call of step() advances by `time_step` whatever dt, so that simulated
/// time differs from real time. It factors in every step, therefore grasps are held and released at
/// once and no refactorisation is required; it has no sensitivity.
class Thesis2018 final : public DeformationModel {
 public:
  /// Throws std::invalid_argument for a quadratic mesh.
  explicit Thesis2018(Body body, const Thesis2018Options& options = {});

  const Body& body() const noexcept override { return body_; }
  void prepare() override;
  void hold(int grasp, const math::Pose& X_OG) noexcept override;
  void release(int grasp) noexcept override;
  bool is_held(int grasp) const noexcept override { return is_held_[grasp]; }
  void set_gravity(const Eigen::Vector3d& gravity_O) noexcept override { gravity_ = gravity_O; }
  Eigen::Matrix3Xd& loads() noexcept override { return loads_; }

  /// The residual is not evaluated after the single Newton step and is reported as zero.
  StepReport step(double dt) noexcept override;
  void reset() noexcept override;
  const Eigen::Matrix3Xd& positions() const noexcept override { return x_; }
  const Eigen::Matrix3Xd& velocities() const noexcept override { return v_; }
  math::Wrench reaction(int grasp) const noexcept override;
  const Sensitivity& sensitivity() const noexcept override { return sensitivity_; }
  Refactorisation* wanted_refactorisation() noexcept override { return nullptr; }
  void install(Refactorisation&) noexcept override {}
  bool restore(const Eigen::Matrix3Xd& positions,
               const Eigen::Matrix3Xd& velocities) noexcept override;

 private:
  void assemble() noexcept;

  Body body_;
  Thesis2018Options options_;
  BodySystem system_;
  factor::Held is_held_{false, false};
  std::array<math::Pose, 2> X_OG_{math::Pose::Identity(), math::Pose::Identity()};
  Eigen::Vector3d gravity_;
  Eigen::Matrix3Xd loads_, x_, v_, impulse_, dv_, product_, reactions_;
  Eigen::MatrixXd rhs_, element_matrix_, element_mass_;
  Sensitivity sensitivity_;
};

}  // namespace palpate::elasticity
