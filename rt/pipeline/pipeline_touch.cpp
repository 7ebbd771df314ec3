// Guarded motions of the first arm, and the conditions under which the robot may move at all.
#include "rt/pipeline/pipeline.hpp"

namespace palpate::pipeline {

const char* Pipeline::begin_touch(const control::TouchRequest& request) noexcept {
  if (components_->guarded_motion == nullptr)
    return "needs the law guarded_motion, see control.law";
  if (!is_running()) return "not active: start first";
  return components_->guarded_motion->begin(request);
}

void Pipeline::cancel_touch() noexcept {
  if (components_->guarded_motion != nullptr) components_->guarded_motion->stop("cancelled");
}

/// Why the robot must not move; nullptr: it may. It must not with an unreliable shape estimate,
/// among obstacles at unknown places, nor with a hand without valid force measurement.
const char* Pipeline::distrust() const noexcept {
  const auto reason_of = [](const Condition& condition, const char* otherwise) {
    return *condition.reason == '\0' ? otherwise : condition.reason;
  };
  const ComponentSet& components = *components_;
  if (obstacle_condition_.state != LifeCycle::kActive)
    return reason_of(obstacle_condition_, "an obstacle's place is unknown");
  for (const ComponentSet::Sensing& instance : components.sensing)
    if (instance.condition.state != LifeCycle::kActive)
      return reason_of(instance.condition, "a sensor model is not active");
  for (const ComponentSet::Contact& instance : components.contact)
    if (instance.condition.state == LifeCycle::kFaulted)
      return reason_of(instance.condition, "the force transformer has faulted");
  if (!trust_.is_usable() || components.estimation_condition.state == LifeCycle::kFaulted)
    return reason_of(components.estimation_condition, "the estimate cannot be used");
  if (components.feature_condition.state == LifeCycle::kFaulted)
    return reason_of(components.feature_condition, "the feature has faulted");
  return nullptr;
}

void Pipeline::move_guarded(double dt) noexcept {
  control::GuardedMotion& motion = *components_->guarded_motion;
  if (!is_running()) return motion.stop("the daemon is not active");
  components_->on_discrepancy.update(trust_.is_in_doubt(), dt);
  if (!motion.is_running()) return;

  const Arm& arm = arms_[0];
  const Eigen::Matrix3d R_WO = arm.frames.X_WO.linear();
  control::GuardedMotion::Inputs inputs;
  inputs.dt = dt;
  const char* reason = distrust();
  if (reason == nullptr && !arm.known) reason = "no robot state yet";
  if (arm.known) inputs.X_WG = arm.signals->robot.latest.X_WE * arm.frames.X_EG;
  bool is_measured = false;
  for (int i = 0; i < contacts_O_.count; ++i) {
    const sensing::Contact& contact = contacts_O_.contacts[i];
    if (!sensing::is_wrist(contact.source, 0)) continue;
    is_measured = true;
    inputs.force_W = R_WO * contact.wrench.force;
  }
  if (reason == nullptr && !is_measured) reason = "no sensor model measures the wrist's force";
  inputs.is_usable = reason == nullptr;
  inputs.reason = reason == nullptr ? "" : reason;
  inputs.is_rejected = arm.output.rejected;
  inputs.gate_reason = arm.output.limited || arm.output.rejected ? arm.output.reason : "";
  const Eigen::Vector3d velocity_W = motion.advance(inputs);
  request(0, {R_WO.transpose() * velocity_W, Eigen::Vector3d::Zero()});
}

}  // namespace palpate::pipeline
