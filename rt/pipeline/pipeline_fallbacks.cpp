// Reaction of the pipeline to faults of components.

#include <cstdio>
#include <utility>

#include "rt/pipeline/pipeline.hpp"

namespace palpate::pipeline {

void Pipeline::report_fallback(const char* slot, const char* reason) noexcept {
  std::snprintf(fallback_reason_.data(), fallback_reason_.size(), "%s: fallback, since %s", slot,
                reason);
  ++fallbacks_taken_;
}

/// False if there is no fallback or it is active already.
bool Pipeline::fall_back(Fallback& fallback, const char* slot, const char* reason) noexcept {
  if (!fallback.replacement || fallback.in_use) return false;
  fallback.in_use = true;
  report_fallback(slot, reason);
  if (take(*fallback.replacement)) return true;
  // the shape is lost
  ComponentSet& incoming = *fallback.replacement->components_;
  incoming.estimator->reset();
  incoming.model->reset();
  incoming.estimator->activate(*incoming.model);
  exchange(*fallback.replacement);
  return true;
}

void Pipeline::check_loads(ComponentSet::Contact& instance, contact::ContactLoads& loads) noexcept {
  if (instance.fallback != nullptr && instance.fallback->in_use() &&
      !std::exchange(instance.fallback_reported, true))
    report_fallback(instance.name.c_str(), "a load of a node is not finite");
  if (registry::are_plausible(loads)) return;
  loads.accepted = false;
  loads.loads.clear();
  instance.condition.apply({Status::kFault, "a load of a node is not finite"});
}

/// Shape available to the controller.
const Eigen::Matrix3Xd& Pipeline::observed_positions() const noexcept {
  return components_->markers ? components_->markers->positions() : components_->model->positions();
}

void Pipeline::update_markers() noexcept {
  if (!components_->markers) return;
  const estimation::ObservationInput& observation = estimation_inputs_.observation;
  components_->markers->look(observation.freshness == Freshness::kNew, observation.age,
                             observation.points_O, components_->model->positions());
}

/// False if the feature is not finite; it is then treated as not observed.
bool Pipeline::feature_is_sound() noexcept {
  ComponentSet& components = *components_;
  if (components.feature_condition.state == LifeCycle::kFaulted) return false;
  components.feature->evaluate(observed_positions(), components.feature_state.value);
  if (components.feature_state.value.allFinite()) return true;
  components.feature_state.value.setZero();
  components.feature_condition.apply({Status::kFault, "the feature is not finite"});
  return false;
}

/// False if the feature is not observed.
bool Pipeline::observe(double dt, int first) noexcept {
  ComponentSet& components = *components_;
  if (components.markers && !components.markers->sees()) {
    components.control_condition.apply({Status::kDegraded, "the markers are not seen"});
    return false;
  }
  const estimation::GraspInput& grasp = estimation_inputs_.grasps[first];
  control::Experience now;
  now.dt = dt;
  now.value = &components.feature_state.value;
  now.positions = &observed_positions();
  now.fresh = !components.markers || components.markers->fresh();
  now.X_OG = grasp.X_OG;
  now.wrench_valid = grasp.wrench_valid;
  now.F_G_O = grasp.F_G_O;
  components.provider->observe(now);
  return true;
}

}  // namespace palpate::pipeline
