#pragma once

#include <array>

#include "core/elasticity/incremental/boundary_conditions.hpp"
#include "core/elasticity/sensitivity.hpp"
#include "core/mesh/point_locator.hpp"

namespace palpate::elasticity {

/// Sensitivity of the equilibrium as computed at a snapshot, and as published: rotated with the
/// nodes, hands and contacts since.
class TrackedSensitivity {
 public:
  /// All must outlive this object. `warp`: rotations of the nodes since the snapshot;
  /// `free_directions`: number of those of the obstacles.
  TrackedSensitivity(const NumberedBody& body, const BoundaryConditions& boundary,
                     const NodeWarp& warp, int free_directions);

  const Sensitivity& published() const noexcept { return published_; }
  const Sensitivity& at_snapshot() const noexcept { return at_snapshot_; }
  const std::array<mesh::PointWeights, kContactSlots>& contacts() const noexcept {
    return contacts_;
  }
  /// From the next factorisation on; the point determines a contact's rotation at once.
  void watch_contact(int slot, const mesh::PointWeights& point) noexcept {
    contacts_[slot] = point;
  }

  /// To be called when the set of held grasps changes.
  void invalidate() noexcept { published_.valid = at_snapshot_.valid = false; }
  /// Takes the sensitivity `computed` at a snapshot `age` seconds ago, when the hands were at
  /// `grasps`, in exchange for the present one, and publishes it rotated.
  void install(Sensitivity& computed, const std::array<math::Pose, 2>& grasps, double age) noexcept;
  void advance(double dt) noexcept { published_.age += dt; }

  /// Publishes the rows of the mesh nodes of part `part` of `parts`, and the wrenches.
  void turn(int part, int parts) noexcept;
  /// Adds the change of a hand's wrench (N, N m, at G in O) since the snapshot to its derivative by
  /// log E: under constant loads the change is proportional to E. After turn().
  void follow_wrench(int g, const math::Vector6d& now) noexcept {
    published_.dw_dparameter[g].col(Sensitivity::kLogYoung) += now - published_.reaction[g];
  }
  /// Replaces the response to motion k of grasp g by `column` (nodal displacements), both as
  /// published and, rotated back, at the snapshot.
  void set_column(int g, int k, const NodalField& column) noexcept;
  /// Rotation of a held hand since the snapshot.
  Eigen::Matrix3d hand_rotation(int grasp) const noexcept;

  /// Adds to `x` the displacements by the pending motions of held hands; none without a valid
  /// sensitivity.
  void follow_hands(NodalField& x) const noexcept;

 private:
  const NumberedBody& body_;
  const BoundaryConditions& boundary_;
  const NodeWarp& warp_;
  std::array<mesh::PointWeights, kContactSlots> contacts_;
  std::array<math::Pose, 2> grasps_{math::Pose::Identity(), math::Pose::Identity()};  // at snapshot
  Sensitivity published_, at_snapshot_;
};

}  // namespace palpate::elasticity
