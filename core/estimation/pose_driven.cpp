#include "core/estimation/pose_driven.hpp"

#include "core/estimation/nodal_loads.hpp"

namespace palpate::estimation {

void PoseDriven::reset() noexcept {
  hands_.reset();
  step_watch_.reset();
}

void PoseDriven::activate(elasticity::DeformationModel& model) noexcept {
  reset();
  model.set_gravity(model.body().gravity_O);
  hands_.activate(model);
}

void PoseDriven::take_over(const Estimate& last, elasticity::DeformationModel& model) noexcept {
  activate(model);
  hands_.take_over(last, model);
}

UpdateResult PoseDriven::update(const EstimationInputs& inputs, elasticity::DeformationModel& model,
                                Estimate& estimate) noexcept {
  UpdateResult result;
  if (!step_guard_.accepts(inputs.dt))
    result = {Status::kDegraded, "time step is not positive and finite"};
  const double dt = step_guard_.step();

  const int grasps = std::min(inputs.grasp_count, static_cast<int>(model.body().grasps.size()));
  for (int i = 0; i < grasps; ++i) {
    result.take(hands_.follow(i, inputs.grasps[i], dt, model));
  }
  // The wrist wrench is the reaction of the held grasp and must not be applied again.
  if (!load_with_contacts(inputs, 1, model))
    result = {Status::kDegraded, "a contact load is not valid"};

  estimate.step = model.step(dt);
  for (int i = 0; i < grasps; ++i) {
    estimate.X_OG[i] = hands_.X_OG(i);
    estimate.reaction[i] = model.reaction(i);
  }
  estimate.log_young_modulus = std::log(model.body().material.young_modulus);
  estimate.poisson_ratio = model.body().material.poisson_ratio;

  const UpdateResult step = step_watch_.judge(estimate.step, dt);
  return step.is_ok() ? result : step;
}

}  // namespace palpate::estimation
