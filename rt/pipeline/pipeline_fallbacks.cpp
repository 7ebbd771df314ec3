// Reaction of the pipeline to faults of components.

#include <cstdio>
#include <utility>

#include "rt/pipeline/pipeline.hpp"

namespace palpate::pipeline {

void Pipeline::tell_fallback(const char* slot, const char* reason) noexcept {
  std::snprintf(fallback_reason_.data(), fallback_reason_.size(), "%s: fallback, since %s", slot,
                reason);
  ++fallbacks_taken_;
}

/// False if there is no fallback or it is active already.
bool Pipeline::fall_back(Fallback& fallback, const char* slot, const char* reason) noexcept {
  if (!fallback.components || fallback.in_use) return false;
  fallback.in_use = true;
  tell_fallback(slot, reason);
  if (take(*fallback.components)) return true;
  // the shape is lost
  Slots& incoming = *fallback.components->slots_;
  incoming.estimator->reset();
  incoming.model->reset();
  incoming.estimator->activate(*incoming.model);
  put_in(*fallback.components);
  return true;
}

void Pipeline::check_loads(Slots::Contact& instance, contact::ContactLoads& loads) noexcept {
  if (instance.fallback != nullptr && instance.fallback->in_use() &&
      !std::exchange(instance.told, true))
    tell_fallback(instance.name.c_str(), "a load of a node is not finite");
  if (registry::are_plausible(loads)) return;
  loads.accepted = false;
  loads.loads.clear();
  instance.condition.apply({sensing::Status::kFault, "a load of a node is not finite"});
}

/// Shape available to the controller.
const Eigen::Matrix3Xd& Pipeline::seen_positions() const noexcept {
  return slots_->sight ? slots_->sight->positions() : slots_->model->positions();
}

void Pipeline::look_at_markers() noexcept {
  if (!slots_->sight) return;
  const estimation::ObservationInput& observation = estimation_inputs_.observation;
  slots_->sight->look(observation.freshness == sensing::Freshness::kNew, observation.age,
                      observation.points_O, slots_->model->positions());
}

/// False if the feature is not finite; it is then treated as not observed.
bool Pipeline::feature_is_sound() noexcept {
  Slots& slots = *slots_;
  if (slots.feature_condition.state == LifeCycle::kFaulted) return false;
  slots.feature->evaluate(seen_positions(), slots.feature_state.value);
  if (slots.feature_state.value.allFinite()) return true;
  slots.feature_state.value.setZero();
  slots.feature_condition.apply({sensing::Status::kFault, "the feature is not finite"});
  return false;
}

/// False if the feature is not observed.
bool Pipeline::look_and_learn(double dt, int first) noexcept {
  Slots& slots = *slots_;
  if (slots.sight && !slots.sight->sees()) {
    slots.control_condition.apply({sensing::Status::kDegraded, "the markers are not seen"});
    return false;
  }
  const estimation::GraspInput& grasp = estimation_inputs_.grasps[first];
  control::Experience now;
  now.dt = dt;
  now.value = &slots.feature_state.value;
  now.positions = &seen_positions();
  now.fresh = !slots.sight || slots.sight->fresh();
  now.X_OG = grasp.X_OG;
  now.wrench_valid = grasp.wrench_valid;
  now.F_G_O = grasp.F_G_O;
  slots.provider->observe(now);
  return true;
}

}  // namespace palpate::pipeline
