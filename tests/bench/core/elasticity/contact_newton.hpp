#pragma once

#include "core/elasticity/element_tangents.hpp"
#include "core/elasticity/incremental/quasi_newton.hpp"
#include "tests/bench/core/elasticity/contact_scene.hpp"

namespace palpate::bench {

/// Parts of a quasi-static solver that do not depend on the formulation of contact.
struct ContactParts {
  ContactParts(const ContactScene& scene, const elasticity::SolverOptions& solver);

  /// Assembles the exact tangent at the present shape in `matrix`.
  void assemble();
  /// Positions of the nodes in mesh order, 3 x n.
  const Eigen::Matrix3Xd& positions();

  elasticity::SolverOptions options;
  elasticity::NumberedBody body;
  elasticity::BoundaryConditions boundary;
  std::vector<mesh::PointWeights> samples;
  elasticity::StepPotential potential;
  elasticity::WarpedFactor factor;
  elasticity::LoopFactor fresh;
  std::unique_ptr<elasticity::ElementTangents> tangents;
  factor::BlockMatrix matrix;
  factor::SupernodalFactor factorisation;
  elasticity::NodalField x;  // m

 private:
  Eigen::Matrix3Xd positions_;
};

/// Newton's method with the exact tangent, factored in each iteration, and the cone problem
/// with the compliances of that factor, until forces and contact laws hold within the tolerances:
/// what a step costs without an incremental solver, and the reference for accuracy.
class ContactNewton {
 public:
  explicit ContactNewton(const ContactScene& scene);

  /// Takes the state before a step: positions in mesh order, and contacts with their forces and
  /// anchors, of the samples of this body.
  void restore(const Eigen::Matrix3Xd& positions,
               const std::vector<elasticity::SurfaceContact>& contacts);
  /// Solves a step whose hand ends at `hand`; false if it has not converged.
  bool step(const math::Pose& hand);

  const Eigen::Matrix3Xd& positions() { return parts_.positions(); }
  int iterations() const { return iterations_; }  // of the last step

 private:
  void refactor();

  ContactParts parts_;
  elasticity::ObstacleContacts contacts_;
  elasticity::QuasiNewton corrections_;
  std::vector<int> wanted_;  // samples whose compliances are needed
  elasticity::Snapshot snapshot_;
  int iterations_ = 0;
};

}  // namespace palpate::bench
