#pragma once

#include "core/elasticity/deformation_model.hpp"

namespace palpate::support {

/// The simplest object that can be held: all of it moves rigidly with the first grasp, and it
/// records its inputs. Reaction: minus the loads and gravity, at the origin of G.
class RigidModel : public elasticity::DeformationModel {
 public:
  explicit RigidModel(elasticity::Body body) : body_(std::move(body)) { prepare(); }

  const elasticity::Body& body() const noexcept override { return body_; }
  void prepare() override {
    velocities_ = loads_ = Eigen::Matrix3Xd::Zero(3, body_.mesh.node_count());
    reset();
  }
  void hold(int grasp, const math::Pose& X_OG) noexcept override {
    held_[grasp] = true;
    X_OG_[grasp] = X_OG;
  }
  void release(int grasp) noexcept override { held_[grasp] = false; }
  bool is_held(int grasp) const noexcept override { return held_[grasp]; }
  void set_gravity(const Eigen::Vector3d& gravity_O) noexcept override { gravity_ = gravity_O; }
  Eigen::Matrix3Xd& loads() noexcept override { return loads_; }
  elasticity::StepReport step(double dt) noexcept override {
    ++steps;
    last_dt = dt;
    if (held_[0]) {
      const math::Pose motion = X_OG_[0] * body_.grasps[0].X_OG_rest.inverse();
      for (int i = 0; i < positions_.cols(); ++i) {
        positions_.col(i) = motion * Eigen::Vector3d(body_.mesh.nodes.col(i));
      }
    }
    return report;
  }
  void reset() noexcept override {
    positions_ = body_.mesh.nodes;
    loads_.setZero();
    held_.fill(false);
  }
  const Eigen::Matrix3Xd& positions() const noexcept override { return positions_; }
  const Eigen::Matrix3Xd& velocities() const noexcept override { return velocities_; }
  math::Wrench reaction(int grasp) const noexcept override {
    math::Wrench wrench;
    if (held_[grasp]) wrench.force = -loads_.rowwise().sum() - gravity_;
    return wrench;
  }
  const elasticity::Sensitivity& sensitivity() const noexcept override { return sensitivity_; }
  elasticity::Refactorisation* wanted_refactorisation() noexcept override { return nullptr; }
  void install(elasticity::Refactorisation&) noexcept override {}
  bool restore(const Eigen::Matrix3Xd&, const Eigen::Matrix3Xd&) noexcept override { return false; }

  const math::Pose& X_OG(int grasp) const { return X_OG_[grasp]; }
  const Eigen::Vector3d& gravity() const { return gravity_; }
  elasticity::Sensitivity& mutable_sensitivity() { return sensitivity_; }

  elasticity::StepReport report{elasticity::StepStatus::kConverged, 1, 0};  // of every step
  int steps = 0;
  double last_dt = 0;

 private:
  elasticity::Body body_;
  std::array<bool, 2> held_{};
  std::array<math::Pose, 2> X_OG_{math::Pose::Identity(), math::Pose::Identity()};
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3Xd positions_, velocities_, loads_;
  elasticity::Sensitivity sensitivity_;
};

/// Bar of 0.5 x 0.06 x 0.06 m along x, clamped at x = 0, held by its other end face; G at the
/// middle of that face with the axes of O.
inline elasticity::Body held_bar(const std::array<int, 3>& cells, mesh::ElementOrder order) {
  elasticity::Body body;
  body.mesh = mesh::make_element_mesh(mesh::make_box({0.5, 0.06, 0.06}, cells), order);
  elasticity::GraspRegion grasp;
  for (int i = 0; i < body.mesh.node_count(); ++i) {
    if (body.mesh.nodes(0, i) < 1e-9) body.fixed_nodes.push_back(i);
    if (body.mesh.nodes(0, i) > 0.5 - 1e-9) grasp.nodes.push_back(i);
  }
  grasp.X_OG_rest.translation() << 0.5, 0.03, 0.03;
  body.grasps.push_back(grasp);
  body.gravity_O << 0, 0, -9.81;
  return body;
}

/// The same with a hand at either end and no other support.
inline elasticity::Body bar_between_hands(mesh::ElementOrder order) {
  elasticity::Body body = held_bar({6, 1, 1}, order);
  elasticity::GraspRegion second;
  second.nodes = std::move(body.fixed_nodes);
  second.X_OG_rest.translation() << 0, 0.03, 0.03;
  body.grasps.push_back(second);
  body.fixed_nodes.clear();
  return body;
}

}  // namespace palpate::support
