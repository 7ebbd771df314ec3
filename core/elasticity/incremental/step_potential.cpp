#include "core/elasticity/incremental/step_potential.hpp"

namespace palpate::elasticity {

StepPotential::StepPotential(const NumberedBody& body, const SolverOptions& options, bool dynamic)
    : body_(body),
      elements_(make_element_forces(body.body.mesh, body.elements.materials(), body.numbering,
                                    options.precision, team_of(options))),
      external_(NodalField::Zero(4, body.node_count())),
      inertial_(external_),
      forces_(external_) {
  if (dynamic) inertia_.emplace(body.elements, body.numbering, team_of(options));
}

void StepPotential::set_time_step(double dt) noexcept {
  dt_ = dt;
  factors_ = {};
  if (!inertia_) return;
  const Damping& damping = body_.body.damping;
  factors_ = {1 / (dt * dt) + damping.mass_factor / dt, damping.stiffness_factor / dt};
}

void StepPotential::begin_step(const BoundaryConditions& boundary) noexcept {
  boundary.external_forces(external_);
  if (factors_.viscous > 0) elements_->begin_step();
  elastic_begin_ = elastic_;
}

void StepPotential::set_inertial_motion(const NodalField& x, const NodalField& v) noexcept {
  inertial_ = x + v * (1 / (dt_ * factors_.inertia));
}

double StepPotential::evaluate(const NodalField& x) noexcept {
  forces_ = -external_;
  double energy = -external_.cwiseProduct(x - body_.rest).sum();
  elastic_ = elements_->add(x, factors_.viscous, forces_);
  energy += elastic_;
  if (inertia_) energy += inertia_->add(x, inertial_, factors_.inertia, forces_);
  return energy;
}

double StepPotential::evaluate_static(const NodalField& x) noexcept {
  forces_.setZero();
  return elements_->add(x, 0, forces_) - external_.cwiseProduct(x - body_.rest).sum();
}

double StepPotential::of_staying(const NodalField& x_begin, const NodalField& v) const noexcept {
  return elastic_begin_ - external_.cwiseProduct(x_begin - body_.rest).sum() +
         inertia_->energy(v, 1 / (factors_.inertia * dt_ * dt_));
}

void StepPotential::forget_history(const NodalField& x) noexcept {
  inertial_ = x;
  elements_->reset();
}

void StepPotential::restart(const NodalField& x) noexcept {
  forces_.setZero();
  elastic_ = elements_->add(x, 0, forces_);
}

void StepPotential::reset() noexcept {
  forces_.setZero();
  elastic_ = 0;
  elements_->reset();
}

}  // namespace palpate::elasticity
