#pragma once

#include <vector>

#include "core/control/control_law.hpp"
#include "core/elasticity/body.hpp"

namespace palpate::published_control {

struct DiminishingRigidityOptions {
  double translation = 4;  // 1/m, k_t, >= 0
  double rotation = 4;     // 1/m, k_r, >= 0
  /// Row [51]: k_t where the hand moves along the way to the node, pushing the object together; the
  /// same as `translation` where the hand pulls, or moves aside. 0: no such difference (row [43]).
  double push = 0;  // 1/m
};

/// Berenson, "Manipulation of deformable objects without modeling and simulating deformation", IROS
/// 2013: row [43] of Table 2.2. With `push` Ruan, McConachie and Berenson, "Accounting for
/// directional rigidity and constraints in control for manipulation of deformable objects without
/// physical simulation", IROS 2018: row [51].
///
/// Consumes: the shape (points and where they are), the hand's pose; no model, probes or parameters
/// of the object but k. Kept: a point follows the hand as on a rigid body, diminished by its
/// distance d from the hand at rest along the object,
///   J = [exp(-k_t d) I, -exp(-k_r d) [x - p_G]x];
/// of [51] that a soft object hands on a pull and gives way under a push: the share of motion along
/// the line from hand to point is exp(-push d) while the hand moves towards the point. Left out:
/// the correction against over-stretch, the avoidance of obstacles, and of [51] the convex program
/// over both (limits are the gate's here). Which way the hand moves is that of the last tick.
class DiminishingRigidity final : public control::JacobianProvider {
 public:
  using Options = DiminishingRigidityOptions;
  /// Distances of all nodes of `body` from its grasp `grasp`. Throws std::invalid_argument where an
  /// option is out of range, or no node is held.
  DiminishingRigidity(const Options& options, const elasticity::Body& body, int grasp);

  void observe(const control::Experience& now) noexcept override;
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
  void reset() noexcept override { moves_ = false; }

 private:
  Options options_;
  std::vector<double> translation_, rotation_, push_;  // share that a node takes over
  const Eigen::Matrix3Xd* positions_ = nullptr;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero(), way_ = Eigen::Vector3d::Zero();
  bool moves_ = false;
};

}  // namespace palpate::published_control
