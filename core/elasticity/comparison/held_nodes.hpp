#pragma once

#include <array>
#include <vector>

#include "core/elasticity/body.hpp"

namespace palpate::elasticity {

/// The nodes whose positions are given: the fixed ones, at rest, and those of each held grasp,
/// which follow X_OG * inverse(X_OG_rest). Refers to a body that must outlive it. Nothing allocates
/// after construction.
class HeldNodes {
 public:
  explicit HeldNodes(const Body& body);

  /// From the next step on; the pose of a grasp that is held already is overwritten.
  void hold(int grasp, const math::Pose& X_OG) noexcept;
  void release(int grasp) noexcept;
  void release_all() noexcept;

  bool is_held(int grasp) const noexcept { return grasps_[grasp].held; }
  unsigned held_set() const noexcept { return grasps_[0].held + 2u * grasps_[1].held; }  // by bit
  bool is_given(int node) const noexcept { return given_[node]; }
  bool poses_are_finite() const noexcept;

  /// Rigid motion of the patch from rest, in O.
  math::Pose motion(int grasp) const noexcept;

  /// Writes the positions of all given nodes into x (3 x n) and leaves the others alone.
  void place(Eigen::Matrix3Xd& x) const noexcept;

  /// The positions now stand for the poses given so far.
  void commit() noexcept;

  /// Wrench about the origin of the committed G, in O, of nodal forces on a held patch; zero where
  /// not held or not committed yet.
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
