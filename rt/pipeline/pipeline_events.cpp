// Changes of the pipeline between ticks: set-up, events, targets, replacements.
#include <utility>

#include "rt/pipeline/pipeline.hpp"
#include "rt/plugin/plugins.hpp"

namespace palpate::pipeline {

Pipeline::Pipeline(const config::Node& root, double period, bool deterministic) {
  build_arms(root);
  cell_.period = period;
  cell_.deterministic = deterministic;
  cell_.inference = registry::read_inference(root, deterministic);
  cell_.remarks = &remarks_;
  cell_.plugins = plugin::Plugins::load(root);
  slots_ = std::make_unique<Slots>(root, cell_, Changes::all(root), nullptr);
  slots_->warm_up();
  fallbacks_ = std::make_unique<Fallbacks>(root, *slots_, room_for_shape());
  remarks_.insert(remarks_.end(), root.warnings().begin(), root.warnings().end());
  whole_ = {LifeCycle::kInactive, "waits for start"};
}

Pipeline::~Pipeline() = default;

void Pipeline::build_arms(const config::Node& root) {
  cell_.frames = registry::read_frames(root);
  cell_.second_frames = registry::read_second_frames(root);
  cell_.gate[0] = registry::read_gate_limits(root);
  cell_.arm_model = registry::read_arm_model(root);
  arms_.emplace_back(cell_.frames, cell_.gate[0]);
  if (cell_.arm_model) {
    arms_[0].model = cell_.arm_model;
    arms_[0].joint_gate.emplace(cell_.arm_model->limits);
    arms_[0].requested_joints.setZero(cell_.arm_model->limits.count());
  }
  if (!cell_.second_frames) return;
  cell_.gate[1] = registry::read_gate_limits(root.child("second_arm"), cell_.gate[0]);
  arms_.emplace_back(*cell_.second_frames, cell_.gate[1]);
}

std::unique_ptr<sensing::SensorModel> Pipeline::exchange_sensor_model(
    int instance, std::unique_ptr<sensing::SensorModel> model) {
  slots_->sensing.at(instance).model.swap(model);
  return model;
}

void Pipeline::start() noexcept {
  if (whole_.state != LifeCycle::kInactive) return;
  whole_ = {LifeCycle::kActive, ""};
  for (Arm& arm : arms_) arm.gate.forget_overload();
  slots_->start();
}

void Pipeline::stop(const char* reason) noexcept {
  if (!is_running()) return;
  whole_ = {LifeCycle::kInactive, reason};
}

void Pipeline::reset() noexcept {
  for (Fallback* fallback : {&fallbacks_->feature, &fallbacks_->steering, &fallbacks_->mechanics})
    if (std::exchange(fallback->in_use, false)) put_in(*fallback->components);
  slots_->reset();
  for (Arm& arm : arms_) arm.gate.forget_overload();
  whole_ = {LifeCycle::kInactive, "reset"};
}

void Pipeline::zero() noexcept {
  for (Slots::Sensing& instance : slots_->sensing) instance.model->zero();
}

void Pipeline::fault(const char* reason) noexcept { whole_ = {LifeCycle::kFaulted, reason}; }

void Pipeline::set_timing_trouble(const char* reason) noexcept {
  if (!is_running()) return;
  whole_ = reason == nullptr ? Condition{LifeCycle::kActive, ""}
                             : Condition{LifeCycle::kDegraded, reason};
}

bool Pipeline::is_running() const noexcept {
  return whole_.state == LifeCycle::kActive || whole_.state == LifeCycle::kDegraded;
}

bool Pipeline::set_target(int revision, const char* kind, const double (*rest_points)[3],
                          int point_count, const double* values, int value_count,
                          const char*& reason) noexcept {
  return slots_->set_target(revision, kind, rest_points, point_count, values, value_count, reason);
}

ShapeSnapshot Pipeline::room_for_shape() const {
  return {slots_->model->positions(), slots_->model->velocities(), slots_->estimate};
}

void Pipeline::copy_shape(ShapeSnapshot& snapshot) const noexcept {
  snapshot.positions = slots_->model->positions();
  snapshot.velocities = slots_->model->velocities();
  snapshot.estimate = slots_->estimate;
}

Pipeline::Along Pipeline::run_along(Replacement& replacement, const char*& reason) noexcept {
  // Minimum number of ticks for which a new sensor model runs in parallel.
  constexpr int kTicks = 100;
  constexpr int kPatience = 2000;  // maximum number, if the present one has no output either
  const bool first = replacement.ticks_along_++ == 0;
  bool ready = true, waits_with_present = true;
  std::vector<Slots::Sensing>& models = replacement.slots_->sensing;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (!models[i].model) continue;
    const int at = replacement.successors_[i];
    const Slots::Sensing* present = at < 0 ? nullptr : &slots_->sensing[at];
    if (first && present != nullptr && !models[i].model->restore(present->model->save())) {
      reason = "is for another kind of sensor than the one in its place";
      return Along::kRefused;
    }
    sensing::ContactSet unused;
    const sensing::UpdateResult result =
        models[i].model->update(*arms_[models[i].arm].signals, unused);
    if (result.status == sensing::Status::kFault) {
      reason = result.reason;
      return Along::kRefused;
    }
    if (result.status == sensing::Status::kOk && replacement.ticks_along_ >= kTicks) continue;
    ready = false;
    if (present == nullptr || present->condition.state != LifeCycle::kActive) continue;
    waits_with_present = false;
    reason = result.reason;
  }
  if (ready || (waits_with_present && replacement.ticks_along_ >= kPatience)) return Along::kReady;
  return replacement.ticks_along_ < kPatience ? Along::kWaits : Along::kRefused;
}

bool Pipeline::take(Replacement& replacement) noexcept {
  const Slots& present = *slots_;
  if (replacement.changes_.mechanics &&
      !replacement.give_shape(present.model->positions(), present.model->velocities(),
                              present.estimate))
    return false;
  put_in(replacement);
  return true;
}

void Pipeline::put_in(Replacement& replacement) noexcept {
  replacement.slots_->adopt(*slots_, replacement.changes_, replacement.successors_);
  slots_.swap(replacement.slots_);
}

}  // namespace palpate::pipeline
