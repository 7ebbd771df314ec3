#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::elasticity {

/// Sample of the surface that touches an obstacle, or may soon. In O.
struct SurfaceContact {
  int sample = 0;
  int obstacle = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, on the object
  bool slips = false;     // under force, and at the limit of friction, after the last step
  bool pressed = false;   // under force after the last step
  bool at_limit = false;  // of friction, with the normal at which the force was computed
  // As last evaluated; a point that could not touch since is not evaluated again:
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   // unit vector out of the obstacle
  double gap = 0;                                      // m, negative inside
  double gap_when_listed = 0;  // m, at the positions from which ContactList counts motion
  /// m, tangential, from the anchor
  Eigen::Vector3d slip = Eigen::Vector3d::Zero();
  /// m, material point of the obstacle, in its frame B, where the sample has stuck last, or was
  /// before it touched: slip counts from there, so that sticking points follow the obstacle and do
  /// not creep
  Eigen::Vector3d anchor_B = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_before = Eigen::Vector3d::Zero();  // N, when the step began
  Eigen::Vector3d last_change = Eigen::Vector3d::Zero();   // N, of the force by the last step

  bool presses() const noexcept { return !force.isZero(0); }
  double normal_force() const noexcept { return normal.dot(force); }  // N
};

inline const std::vector<SurfaceContact> kNoContacts{};

}  // namespace palpate::elasticity
