#pragma once

#include "core/elasticity/contact/compliance_columns.hpp"
#include "core/elasticity/incremental/numbered_body.hpp"
#include "core/elasticity/incremental/solver_options.hpp"
#include "core/factor/solve_panels.hpp"

namespace palpate::elasticity {

/// Coefficients of the loop's matrix: inertia M + K + viscous K_warped. Zero if quasi-static.
struct StepFactors {
  double inertia = 0;  // 1/s^2: 1/h^2 + mass factor / h
  double viscous = 0;  // stiffness factor / h
};

/// Factor used by the loop, and the state from which it was computed.
struct LoopFactor {
  /// `samples`: points of the surface that may touch obstacles, in the solver's numbering.
  LoopFactor(const NumberedBody& body, const SolverOptions& options,
             const std::vector<mesh::PointWeights>& samples)
      : panels(body.supernodes, options.panels, team_of(options)),
        columns(samples, body.pattern.size(), options.contact.most),
        rotations(Eigen::Matrix4Xf::Zero(4, body.pattern.node_count())) {
    rotations.row(0).setOnes();
  }

  factor::SolvePanels panels;
  ComplianceColumns columns;   // compliances of contact points
  Eigen::Matrix4Xf rotations;  // rotations of the nodes at the snapshot, w x y z
  StepFactors step;
  bool usable = false;
  bool exact = false;        // computed from the exact tangent
  bool regularised = false;  // shifted, because the body is unsupported
};

}  // namespace palpate::elasticity
