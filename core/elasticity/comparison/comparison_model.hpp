#pragma once

#include "core/elasticity/deformation_model.hpp"
#include "core/elasticity/comparison/held_nodes.hpp"

namespace palpate::elasticity {

/// What the models for comparison have in common: the state, its boundary and its loads, and a
/// step() that refuses what is not finite and puts the last good state back where advance() fails.
/// They follow grasps made and released at once, want no refactorisation and, unless they say
/// otherwise, have no sensitivity.
class ComparisonModel : public DeformationModel {
 public:
  // The boundary refers to the body.
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

  /// Takes x_ and v_ from the beginning of a step, kept in x_begin_ and v_begin_, to its end and
  /// fills forces_. Inputs are finite, dt > 0.
  virtual StepReport advance(double dt) noexcept = 0;

  const Body body_;
  HeldNodes held_;
  Eigen::Vector3d gravity_;
  Eigen::Matrix3Xd loads_;
  Eigen::Matrix3Xd x_, v_, x_begin_, v_begin_;
  Eigen::Matrix3Xd forces_;  // N, what the outside must add at each node; used at grasped ones
  Sensitivity sensitivity_;

 private:
  Eigen::Matrix3Xd forces_begin_;
  double residual_ = 0;
};

}  // namespace palpate::elasticity
