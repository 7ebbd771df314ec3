#pragma once

#include <memory>
#include <optional>

#include "core/elasticity/incremental/boundary_conditions.hpp"
#include "core/elasticity/incremental/loop_factor.hpp"
#include "core/elasticity/incremental/solver_options.hpp"
#include "core/elasticity/inertia.hpp"

namespace palpate::elasticity {

/// The function of the positions x that a step minimises over the free nodes,
///   E(x) - f.x   and, if dynamic,   + |x - x*|^2_M inertia / 2 + viscous potential,
/// with the energy E of the elements, external forces f, and the positions x* to which the nodes
/// would move by inertia alone. Its derivative are the unbalanced nodal forces.
class StepPotential {
 public:
  /// `body` must outlive this object.
  StepPotential(const NumberedBody& body, const SolverOptions& options, bool dynamic);

  /// Sets the coefficients for steps of `dt` s.
  void set_time_step(double dt) noexcept;
  const StepFactors& factors() const noexcept { return factors_; }

  /// Fixes external forces, and the strains from which viscosity counts.
  void begin_step(const BoundaryConditions& boundary) noexcept;
  /// Adds a force, N, to those at a node (of the solver's numbering), where the potential was
  /// evaluated last too.
  void add_external(int node, const Eigen::Vector3d& force) noexcept {
    external_.col(node).head<3>() += force;
    forces_.col(node).head<3>() -= force;
  }
  /// Sets x* from positions `x` and velocities `v` at the beginning of the step. Dynamic only.
  void set_inertial_motion(const NodalField& x, const NodalField& v) noexcept;

  /// Potential at x, J; forces() and elastic_energy() are then those at x.
  double evaluate(const NodalField& x) noexcept;
  /// Static part of the potential at x, J. Overwrites forces(), not elastic_energy().
  double evaluate_static(const NodalField& x) noexcept;
  /// Upper bound of the minimum, J: the potential if the nodes had remained at `x_begin`, from
  /// which the step began with velocities `v`. A step that ends above it has gained energy. Dynamic
  /// only.
  double of_staying(const NodalField& x_begin, const NodalField& v) const noexcept;

  const NodalField& forces() const noexcept { return forces_; }  // N
  void clear_forces() noexcept { forces_.setZero(); }
  /// Energy of the elements including the viscous potential, J.
  double elastic_energy() const noexcept { return elastic_; }

  ElementForces& elements() noexcept { return *elements_; }
  const ElementForces& elements() const noexcept { return *elements_; }

  /// Continues from positions x without history: x* = x and no strain at the beginning of a step.
  void forget_history(const NodalField& x) noexcept;
  /// Takes strains, rotations and forces of the elements at x as those from which the next step
  /// begins.
  void restart(const NodalField& x) noexcept;
  /// Returns to the rest shape.
  void reset() noexcept;

 private:
  const NumberedBody& body_;
  std::unique_ptr<ElementForces> elements_;
  std::optional<Inertia> inertia_;  // dynamic only
  StepFactors factors_;
  double dt_ = 0;  // s
  NodalField external_, inertial_, forces_;
  double elastic_ = 0, elastic_begin_ = 0;  // J, last evaluated and at the beginning of the step
};

}  // namespace palpate::elasticity
