#pragma once

#include "core/elasticity/contact/obstacle_contacts.hpp"
#include "core/elasticity/deformation_model.hpp"
#include "core/elasticity/incremental/step_potential.hpp"
#include "core/elasticity/incremental/warped_factor.hpp"

namespace palpate::elasticity {

/// Minimises the potential of a step by a few corrections, each the approximate solution for the
/// present unbalanced forces (WarpedFactor), halved while it increases the potential. Learns from
/// each correction, and requests a new factor where corrections contract slowly or fail.
class QuasiNewton {
 public:
  /// All must outlive this object. `contacts`: determines contact forces together with each
  /// correction; null without obstacles.
  QuasiNewton(const NumberedBody& body, const BoundaryConditions& boundary,
              StepPotential& potential, WarpedFactor& factor, ObstacleContacts* contacts,
              const SolverOptions& options);

  /// Improves positions `x`, whose potential, as last evaluated, is `energy` (J), and sets residual
  /// and status; adds to the report's iterations, which count against the limit. The contraction
  /// of corrections is measured in a step that `measures`.
  void minimise(NodalField& x, double& energy, StepReport& report, const StepBudget& budget,
                bool measures) noexcept;

  /// Largest unbalanced force at a free node as last evaluated, N.
  double residual() const noexcept;

  /// To be called when the set of held grasps changes: the measured contraction no longer applies.
  void forget_contraction() noexcept { contraction_ = 1; }
  /// Lifts the limit of the corrections' length that past failures have set.
  void forget_failures() noexcept { reach_ = kUnlimited; }

 private:
  static constexpr double kUnlimited = 1e9;  // m

  double find_correction(const NodalField& x, double& energy) noexcept;
  bool is_contact_settled(const NodalField& x) noexcept;
  double slope() const noexcept;
  void add_correction(const NodalField& from, double share, NodalField& to) const noexcept;
  bool is_last_correction(double size, bool measures) const noexcept;
  void learn(const NodalField& x) noexcept;

  const NumberedBody& body_;
  const BoundaryConditions& boundary_;
  StepPotential& potential_;
  WarpedFactor& factor_;
  ObstacleContacts* contacts_;
  const SolverOptions& options_;
  double rounding_;                                         // relative rounding error of the energy
  Eigen::VectorXf correction_, step_taken_, force_change_;  // three per node, unknown nodes only
  NodalField x_before_, forces_before_;                     // before the present correction
  double reach_ = kUnlimited;  // m, initial limit of a correction's nodal displacement
  /// Ratio of a step's second correction to its first, at the last measurement.
  double contraction_ = 1;
};

}  // namespace palpate::elasticity
