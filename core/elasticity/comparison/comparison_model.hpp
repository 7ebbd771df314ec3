#pragma once

#include <array>
#include <vector>

#include "core/elasticity/body.hpp"
#include "core/elasticity/deformation_model.hpp"

namespace palpate::elasticity {

/// Nodes with prescribed positions: fixed nodes, at rest, and those of each held grasp, which
/// follow X_OG * inverse(X_OG_rest). Refers to a body that must outlive it. Nothing allocates after
/// construction.
class HeldNodes {
 public:
  explicit HeldNodes(const Body& body);

  /// Effective from the next step on; a grasp that is already held gets a new pose.
  void hold(int grasp, const math::Pose& X_OG) noexcept;
  void release(int grasp) noexcept;
  void release_all() noexcept;

  bool is_held(int grasp) const noexcept { return grasps_[grasp].held; }
  // set of held grasps, one bit each
  unsigned held_set() const noexcept { return grasps_[0].held + 2u * grasps_[1].held; }
  bool is_given(int node) const noexcept { return given_[node]; }
  bool poses_are_finite() const noexcept;

  /// Rigid motion of the patch from rest, in O.
  math::Pose motion(int grasp) const noexcept;

  /// Writes the positions of all prescribed nodes into x (3 x n); other columns are unchanged.
  void place(Eigen::Matrix3Xd& x) const noexcept;

  /// Marks the poses set so far as applied to the positions.
  void commit() noexcept;

  /// Wrench about the origin of the applied pose of G, in O, of the nodal forces on a held patch;
  /// zero if not held or not yet applied.
  math::Wrench reaction(int grasp, const Eigen::Matrix3Xd& positions,
                        const Eigen::Matrix3Xd& forces) const noexcept;

 private:
  struct Grasp {
    bool held = false, committed = false;
    math::Pose target = math::Pose::Identity(), applied = math::Pose::Identity();
  };

  const Body* body_;
  std::array<Grasp, 2> grasps_;
  std::vector<char> given_;
};

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
