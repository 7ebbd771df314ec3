#pragma once

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
        rotations(Eigen::Matrix4Xf::Zero(4, supernodes.pattern().node_count())) {
    rotations.row(0).setOnes();
  }

  factor::SolvePanels panels;
  Eigen::Matrix4Xf rotations;  // rotations of the nodes at the snapshot, w x y z
  StepFactors step;
  bool usable = false;
  bool exact = false;        // computed from the exact tangent
  bool regularised = false;  // shifted, because the body is unsupported
};

}  // namespace palpate::elasticity
