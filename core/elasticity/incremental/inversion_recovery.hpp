#pragma once

#include <array>

#include "core/elasticity/incremental/step_potential.hpp"

namespace palpate::elasticity {

/// Smooth shape that satisfies the boundary conditions, without mechanics: each node moves with the
/// hands and the test rig, blended by the inverse squares of their distances at rest. A rigidly
/// moved body remains unstressed; no element is inverted if the motions of the hands are moderate.
class RigidBlend {
 public:
  explicit RigidBlend(const Body& body);

  /// Position of a node when held hands have moved by `motions` from rest.
  Eigen::Vector3d position(int node, const std::array<bool, 2>& held,
                           const std::array<math::Pose, 2>& motions) const noexcept;

 private:
  Eigen::Matrix3Xd rest_;
  /// m^2, squared distance of each node from patch 0, patch 1 and the fixed nodes
  Eigen::Matrix3Xd distance2_;
};

/// Detects shapes that are not physical, and replaces them. The energy has non-physical equilibria:
/// with inverted elements or, after an excessive force, twisted or folded without any. A shape is
/// suspect if it has inverted elements, or had some and is now at rest under strain; one that is
/// suspect in several consecutive checks, or has a tenth of the body inverted in a single one, is
/// compared with that of RigidBlend and replaced by it if that has the lower potential. Each
/// replacement lowers the potential, so that none recurs without new loads or poses. A shape
/// without inverted elements in its past is never replaced, because a hand may well have twisted
/// it.
class InversionRecovery {
 public:
  enum class Outcome {
    kKept,      // the potential is as last evaluated
    kCompared,  // x is unchanged, but the potential must be evaluated again
    kReplaced,  // x is another shape, to be evaluated
  };

  /// All must outlive this object.
  InversionRecovery(const NumberedBody& body, const BoundaryConditions& boundary,
                    StepPotential& potential);

  /// Periodic check of the positions `x`, those of the potential's last evaluation.
  Outcome check(NodalField& x) noexcept;
  /// Check of `x` as above between periodic ones, after a step that did not converge.
  void detect(const NodalField& x) noexcept;
  void forget() noexcept;

  bool is_inverted() const noexcept { return inverted_; }  // at the last periodic check

 private:
  const NumberedBody& body_;
  const BoundaryConditions& boundary_;
  StepPotential& potential_;
  RigidBlend blend_;
  NodalField x_kept_;
  int suspect_count_ = 0;  // consecutive checks with a suspect shape
  bool inverted_ = false;
  bool torn_ = false;            // elements were inverted, and strains have not been small since
  double elastic_at_check_ = 0;  // J, including the viscous potential
};

}  // namespace palpate::elasticity
