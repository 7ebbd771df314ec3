#include "core/elasticity/comparison/comparison_model.hpp"

#include <cmath>
#include <utility>

#include "core/elasticity/static_solver.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Matrix3Xd;

Body checked(Body body) {
  body.check();
  return body;
}

}  // namespace

HeldNodes::HeldNodes(const Body& body) : body_(&body), given_(body.mesh.node_count(), 0) {
  for (int node : body.fixed_nodes) given_[node] = 1;
}

void HeldNodes::hold(int grasp, const math::Pose& X_OG) noexcept {
  grasps_[grasp].target = X_OG;
  if (grasps_[grasp].held) return;
  grasps_[grasp].held = true;
  for (int node : body_->grasps[grasp].nodes) given_[node] = 1;
}

void HeldNodes::release(int grasp) noexcept {
  if (!grasps_[grasp].held) return;
  grasps_[grasp] = Grasp();
  for (int node : body_->grasps[grasp].nodes) given_[node] = 0;
}

void HeldNodes::release_all() noexcept {
  for (int g = 0; g < 2; ++g) release(g);
}

bool HeldNodes::poses_are_finite() const noexcept {
  for (const Grasp& grasp : grasps_) {
    if (grasp.held && !grasp.target.matrix().allFinite()) return false;
  }
  return true;
}

math::Pose HeldNodes::motion(int grasp) const noexcept {
  return grasps_[grasp].target * body_->grasps[grasp].X_OG_rest.inverse();
}

void HeldNodes::place(Eigen::Matrix3Xd& x) const noexcept {
  const Eigen::Matrix3Xd& rest = body_->mesh.nodes;
  for (int node : body_->fixed_nodes) x.col(node) = rest.col(node);
  for (int g = 0; g < 2; ++g) {
    if (!grasps_[g].held) continue;
    const math::Pose moved = motion(g);
    for (int node : body_->grasps[g].nodes) x.col(node) = moved * rest.col(node);
  }
}

void HeldNodes::commit() noexcept {
  for (Grasp& grasp : grasps_) {
    grasp.committed = grasp.held;
    grasp.applied = grasp.target;
  }
}

math::Wrench HeldNodes::reaction(int grasp, const Eigen::Matrix3Xd& positions,
                                 const Eigen::Matrix3Xd& forces) const noexcept {
  if (!grasps_[grasp].committed) return {};
  return patch_wrench(body_->grasps[grasp], grasps_[grasp].applied, positions, forces);
}

ComparisonModel::ComparisonModel(Body body)
    : body_(checked(std::move(body))),
      held_(body_),
      gravity_(body_.gravity_O),
      x_(body_.mesh.nodes),
      x_begin_(x_) {
  for (Matrix3Xd* m : {&loads_, &v_, &v_begin_, &forces_, &forces_begin_}) {
    m->setZero(3, x_.cols());
  }
}

void ComparisonModel::prepare() {
  reset();
  gravity_ = body_.gravity_O;
}

void ComparisonModel::reset() noexcept {
  x_ = body_.mesh.nodes;
  v_.setZero();
  loads_.setZero();
  forces_.setZero();
  residual_ = 0;
  held_.release_all();
}

StepReport ComparisonModel::step(double dt) noexcept {
  StepReport report;
  report.residual = residual_;
  if (!(dt > 0) || !std::isfinite(dt) || !loads_.allFinite() || !gravity_.allFinite() ||
      !held_.poses_are_finite()) {
    return report;
  }
  x_begin_ = x_;
  v_begin_ = v_;
  forces_begin_ = forces_;
  const StepReport done = advance(dt);
  if (done.status == StepStatus::kFailed || !std::isfinite(done.residual) || !x_.allFinite() ||
      !v_.allFinite() || !forces_.allFinite()) {
    x_ = x_begin_;
    v_ = v_begin_;
    forces_ = forces_begin_;
    return report;
  }
  held_.commit();
  residual_ = done.residual;
  return done;
}

math::Wrench ComparisonModel::reaction(int grasp) const noexcept {
  return held_.reaction(grasp, x_, forces_);
}

bool ComparisonModel::restore(const Matrix3Xd& positions, const Matrix3Xd& velocities) noexcept {
  if (positions.cols() != x_.cols() || velocities.cols() != x_.cols() || !positions.allFinite() ||
      !velocities.allFinite()) {
    return false;
  }
  x_ = positions;
  v_ = velocities;
  forces_.setZero();
  for (int node : body_.fixed_nodes) {
    x_.col(node) = body_.mesh.nodes.col(node);
    v_.col(node).setZero();
  }
  return true;
}

}  // namespace palpate::elasticity
