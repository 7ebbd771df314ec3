#pragma once

#include "core/elasticity/deformation_model.hpp"
#include "core/elasticity/element_tangents.hpp"
#include "core/elasticity/static_response.hpp"
#include "core/factor/solve_panels.hpp"

namespace palpate::elasticity {

/// Coefficients of the loop's matrix: inertia M + K + viscous K_warped. Zero if quasi-static.
struct StepFactors {
  double inertia = 0;  // 1/s^2: 1/h^2 + mass factor / h
  double viscous = 0;  // stiffness factor / h
};

/// Factor used by the loop, and the state from which it was computed.
struct LoopFactor {
  LoopFactor(const factor::Supernodes& supernodes, factor::PanelPrecision precision,
             math::Team& team)
      : panels(supernodes, precision, team),
        rotations(Eigen::Matrix4Xf::Zero(4, supernodes.pattern().size())) {
    rotations.row(0).setOnes();
  }

  factor::SolvePanels panels;
  Eigen::Matrix4Xf rotations;  // rotations of the unknown nodes at the snapshot, w x y z
  StepFactors step;
  bool usable = false;
  bool exact = false;        // computed from the exact tangent
  bool regularised = false;  // shifted, because the body is unsupported
};

/// Assembles the tangent at a snapshot, factors it for the loop and derives from the exact static
/// tangent the sensitivity of the equilibrium to grasps, parameters and contacts. Snapshot and
/// results are plain members: the model fills the former before run() and reads the latter after
/// it.
class RefactorJob final : public Refactorisation {
 public:
  /// `team` is used by the loop when it solves with the factor; the job itself runs in the calling
  /// thread.
  RefactorJob(const Body& body, const ElementSet& elements, const factor::Supernodes& supernodes,
              factor::PanelPrecision precision, math::Team& team);

  void run() noexcept override;

  Snapshot snapshot;  // further inputs: factor.rotations, factor.step

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
