#pragma once

#include "core/elasticity/deformation_model.hpp"
#include "core/elasticity/element_tangents.hpp"
#include "core/elasticity/static_response.hpp"
#include "core/factor/solve_panels.hpp"

namespace palpate::elasticity {

/// What the loop's matrix is made of: inertia M + K + viscous K_warped. Zero where quasi-static.
struct StepFactors {
  double inertia = 0;  // 1/s^2: 1/h^2 + mass factor / h
  double viscous = 0;  // stiffness factor / h
};

/// Factor that a loop solves with, and what it was made from.
struct LoopFactor {
  LoopFactor(const factor::Supernodes& supernodes, factor::PanelPrecision precision,
             math::Team& team)
      : panels(supernodes, precision, team),
        rotations(Eigen::Matrix4Xf::Zero(4, supernodes.pattern().size())) {
    rotations.row(0).setOnes();
  }

  factor::SolvePanels panels;
  Eigen::Matrix4Xf rotations;  // of the unknown nodes at the snapshot, w x y z
  StepFactors step;
  bool usable = false;
  bool exact = false;        // of the exact tangent
  bool regularised = false;  // shifted, since nothing stops the body from moving as a whole
};

/// Assembles the tangent at a snapshot, factors it for the loop and derives from the exact static
/// tangent how equilibrium follows grasps, parameters and contacts. Snapshot and results are plain
/// members; the model fills the first before run() and takes the second after it.
class RefactorJob final : public Refactorisation {
 public:
  /// `team` is for the loop, to solve with the factor; the job runs in the thread that calls it.
  RefactorJob(const Body& body, const ElementSet& elements, const factor::Supernodes& supernodes,
              factor::PanelPrecision precision, math::Team& team);

  void run() noexcept override;

  Snapshot snapshot;  // and factor.rotations, factor.step

  // Results.
  LoopFactor factor;
  Sensitivity sensitivity;

 private:
  void assemble(Tangent kind);
  void add_step();
  bool factorise(double shift = 0);

  const factor::BlockPattern& pattern_;
  std::unique_ptr<ElementTangents> tangents_;
  factor::BlockMatrix matrix_, warped_;
  Eigen::VectorXd mass_;  // kg, by block
  factor::SupernodalFactor factorisation_;
  StaticResponse response_;
  std::unique_ptr<StressEvaluator> stress_;
};

}  // namespace palpate::elasticity
