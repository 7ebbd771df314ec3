// Changes of the pipeline between ticks: set-up, events, targets, replacements.
#include <utility>

#include "core/frames/frame_check.hpp"
#include "rt/pipeline/pipeline.hpp"
#include "rt/plugin/plugins.hpp"

namespace palpate::pipeline {
namespace {

constexpr const char* kNoObject = "the configuration has no object: only senses";

}  // namespace

Pipeline::Pipeline(const config::Node& root, double period, bool deterministic) {
  build_arms(root);
  cell_.period = period;
  cell_.deterministic = deterministic;
  cell_.inference = registry::read_inference(root, deterministic);
  cell_.remarks = &remarks_;
  cell_.plugins = plugin::Plugins::load(root);
  components_ = std::make_unique<ComponentSet>(root, cell_, Changes::all(root), nullptr);
  obstacles_ = std::make_unique<ObstacleMotion>(components_->object->obstacles, cell_.frames.X_WO);
  jaws_ = std::make_unique<JawWatch>(*components_->object);
  components_->warm_up();
  fallbacks_ = std::make_unique<Fallbacks>(root, *components_, room_for_shape());
  remarks_.insert(remarks_.end(), root.warnings().begin(), root.warnings().end());
  whole_ = {LifeCycle::kInactive, has_object() ? "waits for start" : kNoObject};
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
  components_->sensing.at(instance).model.swap(model);
  return model;
}

/// Why the arm's messages contradict its frames or its URDF; "" if nothing shows that.
const char* Pipeline::wrong_frames(const Arm& arm) noexcept {
  if (arm.signals == nullptr || !arm.known) return "";
  if (arm.model && !arm.joints_known)
    return arm.signals->robot.latest.joint_count == arm.model->chain.joint_count()
               ? "ROBOT_STATE: the flange is not where the joints and robot.urdf have it"
               : "ROBOT_STATE has another number of joints than robot.urdf";
  return frames::frame_contradiction(arm.measurements());
}

const char* Pipeline::start() noexcept {
  if (!has_object()) return kNoObject;
  if (whole_.state != LifeCycle::kInactive) return is_running() ? "" : "faulted: reset first";
  for (const Arm& arm : arms_)
    if (const char* reason = wrong_frames(arm); *reason != '\0') return reason;
  whole_ = {LifeCycle::kActive, ""};
  obstacle_condition_ = jaw_condition_ = {LifeCycle::kActive, ""};
  for (Arm& arm : arms_) arm.gate.forget_overload();
  trust_.reset();
  components_->start();
  return "";
}

void Pipeline::stop(const char* reason) noexcept {
  if (!is_running()) return;
  whole_ = {LifeCycle::kInactive, reason};
}

void Pipeline::reset() noexcept {
  for (Fallback* fallback : {&fallbacks_->feature, &fallbacks_->steering, &fallbacks_->mechanics})
    if (std::exchange(fallback->in_use, false)) exchange(*fallback->replacement);
  components_->reset();
  for (Arm& arm : arms_) arm.gate.forget_overload();
  whole_ = {LifeCycle::kInactive, has_object() ? "reset" : kNoObject};
}

void Pipeline::zero() noexcept {
  for (ComponentSet::Sensing& instance : components_->sensing) instance.model->zero();
}

void Pipeline::fault(const char* reason) noexcept { whole_ = {LifeCycle::kFaulted, reason}; }

void Pipeline::set_timing(const UpdateResult& timing) noexcept { whole_.apply(timing); }

bool Pipeline::is_running() const noexcept {
  return whole_.state == LifeCycle::kActive || whole_.state == LifeCycle::kDegraded;
}

bool Pipeline::set_target(int revision, const char* kind, const double (*rest_points)[3],
                          int point_count, const double* values, int value_count,
                          const char*& reason) noexcept {
  return components_->set_target(revision, kind, rest_points, point_count, values, value_count,
                                 reason);
}

ShapeSnapshot Pipeline::room_for_shape() const {
  if (!has_object()) return {};
  return {components_->model->positions(), components_->model->velocities(), components_->estimate};
}

void Pipeline::copy_shape(ShapeSnapshot& snapshot) const noexcept {
  if (!has_object()) return;
  snapshot.positions = components_->model->positions();
  snapshot.velocities = components_->model->velocities();
  snapshot.estimate = components_->estimate;
}

Pipeline::WarmupState Pipeline::warm_up(Replacement& replacement, const char*& reason) noexcept {
  // Minimum number of ticks for which a new sensor model runs in parallel.
  constexpr int kTicks = 100;
  constexpr int kPatience = 2000;  // maximum number, if the present one has no output either
  const bool first = replacement.warmup_ticks_++ == 0;
  bool ready = true, waits_with_present = true;
  std::vector<ComponentSet::Sensing>& models = replacement.components_->sensing;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (!models[i].model) continue;
    const int at = replacement.successors_[i];
    const ComponentSet::Sensing* present = at < 0 ? nullptr : &components_->sensing[at];
    if (first && present != nullptr && !models[i].model->restore(present->model->save())) {
      reason = "is for another kind of sensor than the one in its place";
      return WarmupState::kRejected;
    }
    sensing::ContactSet unused;
    const UpdateResult result = models[i].model->update(*arms_[models[i].arm].signals, unused);
    if (result.status == Status::kFault) {
      reason = result.reason;
      return WarmupState::kRejected;
    }
    if (result.status == Status::kOk && replacement.warmup_ticks_ >= kTicks) continue;
    ready = false;
    if (present == nullptr || present->condition.state != LifeCycle::kActive) continue;
    waits_with_present = false;
    reason = result.reason;
  }
  if (ready || (waits_with_present && replacement.warmup_ticks_ >= kPatience))
    return WarmupState::kReady;
  return replacement.warmup_ticks_ < kPatience ? WarmupState::kRunning : WarmupState::kRejected;
}

bool Pipeline::take(Replacement& replacement) noexcept {
  const ComponentSet& present = *components_;
  if (replacement.changes_.mechanics &&
      !replacement.give_shape(present.model->positions(), present.model->velocities(),
                              present.estimate))
    return false;
  exchange(replacement);
  return true;
}

void Pipeline::exchange(Replacement& replacement) noexcept {
  replacement.components_->adopt(*components_, replacement.changes_, replacement.successors_);
  components_.swap(replacement.components_);
}

}  // namespace palpate::pipeline
