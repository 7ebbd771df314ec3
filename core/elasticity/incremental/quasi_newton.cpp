#include "core/elasticity/incremental/quasi_newton.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::elasticity {

QuasiNewton::QuasiNewton(const NumberedBody& body, const BoundaryConditions& boundary,
                         StepPotential& potential, WarpedFactor& factor, ObstacleContacts* contacts,
                         const SolverOptions& options)
    : body_(body),
      boundary_(boundary),
      potential_(potential),
      factor_(factor),
      contacts_(contacts),
      options_(options),
      rounding_(options.precision == Precision::kSingle ? 1e-6 : 1e-12),
      correction_(Eigen::VectorXf::Zero(3 * body.pattern.size())),
      step_taken_(correction_),
      force_change_(correction_),
      x_before_(NodalField::Zero(4, body.node_count())),
      forces_before_(x_before_) {}

double QuasiNewton::residual() const noexcept {
  return boundary_.largest_at_free_nodes(potential_.forces());
}

/// Computes correction_ of positions x; returns the slope of the potential along it, J. Contact
/// forces change with it, and `energy` with them.
double QuasiNewton::find_correction(const NodalField& x, double& energy) noexcept {
  const NodalField& forces = potential_.forces();
  for (int k = 0; k < body_.pattern.size(); ++k) {
    correction_.segment<3>(3 * k) = -forces.col(k).head<3>().cast<float>();
  }
  factor_.solve(correction_, boundary_);
  if (contacts_ != nullptr) energy += contacts_->correct(x, correction_, potential_);
  return slope();
}

bool QuasiNewton::is_contact_settled(const NodalField& x) noexcept {
  return contacts_ == nullptr || contacts_->violation(x) <= contacts_->tolerance();
}

/// Slope of the potential, as last evaluated, along correction_, J.
double QuasiNewton::slope() const noexcept {
  const NodalField& forces = potential_.forces();
  double sum = 0;
  for (int k = 0; k < body_.pattern.size(); ++k) {
    sum += forces.col(k).head<3>().dot(correction_.segment<3>(3 * k).cast<double>());
  }
  return sum;
}

void QuasiNewton::add_correction(const NodalField& from, double share,
                                 NodalField& to) const noexcept {
  for (int k = 0; k < body_.pattern.size(); ++k) {
    to.col(k).head<3>() =
        from.col(k).head<3>() + share * correction_.segment<3>(3 * k).cast<double>();
  }
}

/// Whether the next correction is expected to be below the accuracy after one that moves no node by
/// more than `size` m. A correction that `measures` must be followed by another, because the
/// remaining forces say little about remaining errors in soft motions.
bool QuasiNewton::is_last_correction(double size, bool measures) const noexcept {
  return !measures && contraction_ < 1 && contraction_ * size < options_.accuracy;
}

void QuasiNewton::learn(const NodalField& x) noexcept {
  const NodalField& forces = potential_.forces();
  for (int k = 0; k < body_.pattern.size(); ++k) {
    step_taken_.segment<3>(3 * k) = (x.col(k) - x_before_.col(k)).head<3>().cast<float>();
    force_change_.segment<3>(3 * k) =
        (forces.col(k) - forces_before_.col(k)).head<3>().cast<float>();
  }
  boundary_.clear_held_nodes(force_change_);
  factor_.secants().add(step_taken_, force_change_);
}

void QuasiNewton::minimise(NodalField& x, double& energy, StepReport& report,
                           const StepBudget& budget, bool measures) noexcept {
  report.residual = residual();
  bool settled = report.residual <= options_.tolerance && is_contact_settled(x);
  double last_size = 0;
  while (!settled && report.iterations < options_.iterations && !budget.is_spent()) {
    const double slope_begin = find_correction(x, energy);
    const auto size = static_cast<double>(correction_.lpNorm<Eigen::Infinity>());
    if (last_size > 0) contraction_ = size / last_size;
    ++report.iterations;
    const bool is_last = is_last_correction(size, measures && report.iterations == 1);
    if (is_last && !options_.confirm && potential_.factors().viscous == 0 && factor_.is_exact() &&
        slope_begin < 0) {
      add_correction(x, 1, x);
      report.residual *= contraction_;
      settled = true;
      break;
    }
    x_before_ = x;
    forces_before_ = potential_.forces();

    // A nearly singular tangent requests very large corrections repeatedly: after a failure their
    // length is limited.
    const double longest = std::min(1.0, reach_ / size);
    bool accepted = false;
    double share = longest, next = energy, next_residual = report.residual;
    for (int halving = 0; halving <= options_.halvings; ++halving, share *= 0.5) {
      add_correction(x_before_, share, x);
      next = potential_.evaluate(x);
      next_residual = residual();
      // Near the minimum rounding errors exceed the decrease of the energy, which is then computed
      // from slopes: along a parabola it is their mean (approximate Wolfe condition, Hager and
      // Zhang 2005).
      const double rounding = rounding_ * (std::abs(energy) + std::abs(next));
      accepted = next <= energy + 1e-4 * share * slope_begin ||
                 (std::abs(next - energy) <= rounding && slope() < -0.9 * slope_begin);
      if (accepted) break;
    }
    if (!accepted) {
      reach_ = share * size;
      x = x_before_;
      potential_.evaluate(x);
      factor_.secants().clear();
      factor_.want_new();
      break;
    }
    reach_ = longest < 1 ? 4 * share * size : kUnlimited;
    if (next_residual > options_.tolerance &&
        next_residual > options_.contraction * report.residual) {
      factor_.want_new();
    }
    // far from equilibrium, where the tangent is indefinite, secant pairs mislead
    if (factor_.is_exact()) learn(x);
    energy = next;
    report.residual = next_residual;
    last_size = share == 1 ? size : 0;
    settled = is_last || (next_residual <= options_.tolerance && is_contact_settled(x));
  }
  report.status = settled ? StepStatus::kConverged : StepStatus::kNotConverged;
}

}  // namespace palpate::elasticity
