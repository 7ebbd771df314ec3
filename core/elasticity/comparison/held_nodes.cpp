#include "core/elasticity/comparison/held_nodes.hpp"

#include "core/elasticity/static_solver.hpp"

namespace palpate::elasticity {

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

}  // namespace palpate::elasticity
