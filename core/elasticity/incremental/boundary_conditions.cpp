#include "core/elasticity/incremental/boundary_conditions.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::elasticity {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

BoundaryConditions::BoundaryConditions(const NumberedBody& body)
    : body_(body),
      gravity_(body.body.gravity_O),
      loads_(Matrix3Xd::Zero(3, body.node_count())),
      weight_per_gravity_(NodalField::Zero(4, body.node_count())) {
  for (int node = 0; node < body.node_count(); ++node) {
    weight_per_gravity_.col(body.numbering[node]).setConstant(body.elements.nodal_mass()(node));
  }
  weight_per_gravity_.row(3).setZero();
}

bool BoundaryConditions::hold(int grasp, const math::Pose& X_OG,
                              const Matrix3Xd& positions) noexcept {
  target_[grasp] = X_OG;
  if (held_[grasp]) return false;
  held_[grasp] = true;
  applied_[grasp] = grasp_pose(body_.body, grasp, positions);
  return true;
}

bool BoundaryConditions::release(int grasp) noexcept {
  const bool was_held = held_[grasp];
  held_[grasp] = false;
  return was_held;
}

void BoundaryConditions::clear() noexcept {
  held_ = {false, false};
  loads_.setZero();
}

bool BoundaryConditions::are_finite() const noexcept {
  if (!loads_.allFinite() || !gravity_.allFinite()) return false;
  for (int g = 0; g < 2; ++g) {
    if (held_[g] && !target_[g].matrix().allFinite()) return false;
  }
  return true;
}

void BoundaryConditions::apply(NodalField& x) noexcept {
  for (int g = 0; g < body_.grasp_count(); ++g) {
    if (!held_[g]) continue;
    applied_[g] = target_[g];
    const math::Pose moved = motion_from_rest(g);
    for (int node : body_.body.grasps[g].nodes) {
      x.col(body_.numbering[node]).head<3>() = moved * body_.body.mesh.nodes.col(node);
    }
  }
}

void BoundaryConditions::set_applied_by(const Matrix3Xd& positions) noexcept {
  for (int g = 0; g < 2; ++g) {
    if (held_[g]) applied_[g] = grasp_pose(body_.body, g, positions);
  }
}

math::Pose BoundaryConditions::motion_from_rest(int grasp) const noexcept {
  return applied_[grasp] * body_.body.grasps[grasp].X_OG_rest.inverse();
}

math::Vector6d BoundaryConditions::pending_motion(int grasp) const noexcept {
  const math::Pose &target = target_[grasp], &applied = applied_[grasp];
  math::Vector6d motion;
  motion << target.translation() - applied.translation(),
      math::log_rotation(target.linear() * applied.linear().transpose());
  return motion;
}

void BoundaryConditions::external_forces(NodalField& forces) const noexcept {
  for (int node = 0; node < loads_.cols(); ++node) {
    forces.col(body_.numbering[node]).head<3>() = loads_.col(node);
  }
  forces.topRows<3>() += gravity_.asDiagonal() * weight_per_gravity_.topRows<3>();
}

double BoundaryConditions::largest_at_free_nodes(const NodalField& forces) const noexcept {
  const factor::BlockPattern& pattern = body_.pattern;
  double largest = 0;
  for (int k = 0; k < pattern.interior_size(); ++k) {
    largest = std::max(largest, forces.col(k).squaredNorm());
  }
  for (int g = 0; g < 2; ++g) {
    for (int k = pattern.border_begin(g); k < pattern.border_end(g) && !held_[g]; ++k) {
      largest = std::max(largest, forces.col(k).squaredNorm());
    }
  }
  return std::sqrt(largest);
}

void BoundaryConditions::clear_held_nodes(Eigen::VectorXf& b) const noexcept {
  for (int g = 0; g < 2; ++g) {
    const int begin = body_.pattern.border_begin(g);
    if (held_[g]) b.segment(3 * begin, 3 * (body_.pattern.border_end(g) - begin)).setZero();
  }
}

math::Wrench BoundaryConditions::reaction(int grasp, const NodalField& forces,
                                          const Matrix3Xd& positions) const noexcept {
  math::Wrench wrench;
  if (!held_[grasp]) return wrench;
  const Vector3d origin = applied_[grasp].translation();
  for (int node : body_.body.grasps[grasp].nodes) {
    const Vector3d force = forces.col(body_.numbering[node]).head<3>();
    wrench.force += force;
    wrench.torque += (positions.col(node) - origin).cross(force);
  }
  return wrench;
}

}  // namespace palpate::elasticity
