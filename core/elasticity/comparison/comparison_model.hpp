#pragma once

#include "core/elasticity/comparison/held_nodes.hpp"
#include "core/elasticity/deformation_model.hpp"

namespace palpate::elasticity {

/// Base of the comparison models: state, boundary conditions and loads, and a step() that rejects
/// non-finite inputs and restores the last valid state if advance() fails. Grasps are held and
/// released at once, no refactorisation is required and, unless overridden, there is no
/// sensitivity.
class ComparisonModel : public DeformationModel {
 public:
  // the boundary conditions refer to the body
  ComparisonModel(const ComparisonModel&) = delete;
  ComparisonModel& operator=(const ComparisonModel&) = delete;

  const Body& body() const noexcept override { return body_; }
  void prepare() override;
  void hold(int grasp, const math::Pose& X_OG) noexcept override { held_.hold(grasp, X_OG); }
  void release(int grasp) noexcept override { held_.release(grasp); }
  bool is_held(int grasp) const noexcept override { return held_.is_held(grasp); }
  void set_gravity(const Eigen::Vector3d& gravity_O) noexcept override { gravity_ = gravity_O; }
  Eigen::Matrix3Xd& loads() noexcept override { return loads_; }
  StepReport step(double dt) noexcept final;
  void reset() noexcept override;
  const Eigen::Matrix3Xd& positions() const noexcept override { return x_; }
  const Eigen::Matrix3Xd& velocities() const noexcept override { return v_; }
  math::Wrench reaction(int grasp) const noexcept override;
  const Sensitivity& sensitivity() const noexcept override { return sensitivity_; }
  Refactorisation* wanted_refactorisation() noexcept override { return nullptr; }
  void install(Refactorisation&) noexcept override {}
  bool restore(const Eigen::Matrix3Xd& positions,
               const Eigen::Matrix3Xd& velocities) noexcept override;

 protected:
  /// Throws std::invalid_argument for an invalid body.
  explicit ComparisonModel(Body body);

  /// Advances x_ and v_ from the beginning of a step (also in x_begin_ and v_begin_) to its end and
  /// fills forces_. Inputs are finite, dt > 0.
  virtual StepReport advance(double dt) noexcept = 0;

  const Body body_;
  HeldNodes held_;
  Eigen::Vector3d gravity_;
  Eigen::Matrix3Xd loads_;
  Eigen::Matrix3Xd x_, v_, x_begin_, v_begin_;
  Eigen::Matrix3Xd forces_;  // N, external force required at each node; used at grasped nodes
  Sensitivity sensitivity_;

 private:
  Eigen::Matrix3Xd forces_begin_;
  double residual_ = 0;
};

}  // namespace palpate::elasticity
