#pragma once

#include <array>
#include <vector>

#include "core/elasticity/body.hpp"

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

}  // namespace palpate::elasticity
