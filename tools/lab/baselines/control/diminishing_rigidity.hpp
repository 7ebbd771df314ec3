#pragma once

#include <vector>

#include "core/control/control_law.hpp"
#include "core/elasticity/body.hpp"

namespace palpate::baselines {

struct DiminishingRigidityOptions {
  double translation = 4;  // 1/m, k_t, >= 0
  double rotation = 4;     // 1/m, k_r, >= 0
  /// Row [51]: rate of decay when the hand moves towards the node (compression); `translation`
  /// applies to tension and lateral motion. 0: no distinction (row [43]).
  double push = 0;  // 1/m
};

/// Berenson, "Manipulation of deformable objects without modeling and simulating deformation", IROS
/// 2013: row [43] of Table 2.2 in Sanchez 2019. With `push`: Ruan, McConachie and Berenson,
/// "Accounting for directional rigidity and constraints in control for manipulation of deformable
/// objects without physical simulation", IROS 2018: row [51].
///
/// Consumes: the shape (points and their positions), the pose of the hand; no model, probing
/// motions or parameters of the object except k. Kept: a point follows the hand as on a rigid body,
/// attenuated with its distance d from the hand at rest along the object, J = [exp(-k_t d) I,
/// -exp(-k_r d) [x - p_G]x]; from [51] that a soft object transmits tension but yields under
/// compression: the component of motion along the line from hand to point is scaled by exp(-push d)
/// while the hand moves towards the point. Left out: the correction of over-stretch, obstacle
/// avoidance, and the convex program of [51] for both (limits are enforced by the gate here). The
/// direction of the hand's motion is that of the last tick.
class DiminishingRigidity final : public control::JacobianProvider {
 public:
  using Options = DiminishingRigidityOptions;
  /// Computes the distances of all nodes of `body` from grasp `grasp`. Throws std::invalid_argument
  /// if an option is out of range or no node is held.
  DiminishingRigidity(const Options& options, const elasticity::Body& body, int grasp);

  void observe(const control::Experience& now) noexcept override;
  bool update(const shape::Feature& feature, const elasticity::DeformationModel& model,
              const math::Pose& X_OG, Eigen::Ref<Eigen::MatrixXd> J) noexcept override;
  void reset() noexcept override { moves_ = false; }

 private:
  Options options_;
  /// Fraction of the hand's motion transmitted to each node.
  std::vector<double> translation_, rotation_, push_;
  const Eigen::Matrix3Xd* positions_ = nullptr;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero(), way_ = Eigen::Vector3d::Zero();
  bool moves_ = false;
};

}  // namespace palpate::baselines
