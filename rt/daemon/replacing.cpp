#include "rt/daemon/replacing.hpp"

#include "rt/bus/text.hpp"

namespace palpate::daemon {

Replacing::Replacing(const config::Node& root, pipeline::Pipeline& pipeline, Telemetry& telemetry,
                     bus::MessageBus& housekeeping, int delay)
    : pipeline_(pipeline),
      telemetry_(telemetry),
      housekeeping_(housekeeping),
      delay_(delay),
      root_{root, root.hash()},
      snapshot_(pipeline.room_for_shape()) {}

const char* Replacing::request(const component_command_t& command, std::int64_t cycle) noexcept {
  if (pipeline_.on_fallback()) return "a fallback runs: reset first";
  if (state_ != State::kIdle) return "another replacement is under way";
  command_ = command;
  grasp_.reset();
  submit(cycle);
  return "";
}

bool Replacing::request(const pipeline::ClosedGrasp& grasp, std::int64_t cycle) noexcept {
  if (pipeline_.on_fallback() || state_ != State::kIdle) return false;
  command_ = {};
  command_.counter = -1;
  bus::put_text(command_.slot, "object");
  grasp_ = grasp;
  submit(cycle);
  return true;
}

void Replacing::submit(std::int64_t cycle) noexcept {
  pipeline_.copy_shape(snapshot_);
  reason_.fill('\0');
  due_ = cycle + delay_;
  state_ = State::kBuilding;
  worker_.submit([](void* self) noexcept { static_cast<Replacing*>(self)->build(); }, this);
}

/// The configuration after the request. Throws config::Error.
config::Node Replacing::wanted() const {
  pipeline::ReplaceRequest request;
  request.slot = bus::get_text(command_.slot);
  request.instance = bus::get_text(command_.instance);
  request.component = bus::get_text(command_.component);
  request.parameters =
      grasp_ ? pipeline::found_grasp(*pipeline_.components().object, *grasp_, snapshot_.positions)
             : bus::get_text(command_.parameters);
  return pipeline::apply_request(root_.node, request);
}

/// Runs in the worker's thread.
void Replacing::build() noexcept {
  try {
    const config::Node next = wanted();
    wanted_ = std::make_unique<Root>(Root{next, next.hash()});
    auto replacement = std::make_unique<pipeline::Replacement>(root_.node, next,
                                                               pipeline_.components(), snapshot_);
    if (replacement->changes().object) {
      const registry::Object& object = *replacement->components().object;
      mesh_ = std::make_unique<MeshTelemetry>(housekeeping_, object);
      const Eigen::Matrix3Xd nodes = object.body.mesh.nodes;
      next_snapshot_ = std::make_unique<pipeline::ShapeSnapshot>(
          pipeline::ShapeSnapshot{nodes, 0 * nodes, snapshot_.estimate});
    }
    fallbacks_ = std::make_unique<pipeline::Fallbacks>(
        next, replacement->components(), next_snapshot_ ? *next_snapshot_ : snapshot_);
    replacement_ = std::move(replacement);
  } catch (const std::exception& error) {
    bus::put_text(reason_, error.what());
  }
}

void Replacing::clean() noexcept {
  wanted_.reset();
  replacement_.reset();
  fallbacks_.reset();
  mesh_.reset();
  next_snapshot_.reset();
}

Replacing::Outcome Replacing::service(Refactoring& refactoring, std::int64_t cycle) noexcept {
  if (state_ == State::kIdle) return Outcome::kNothing;
  if (state_ == State::kCleaning) {
    if ((delay_ < 0 ? worker_.finished() : worker_.wait()) != nullptr) state_ = State::kIdle;
    return Outcome::kNothing;
  }
  if (state_ == State::kBuilding) {
    if (delay_ >= 0 && cycle < due_) return Outcome::kNothing;
    if ((delay_ < 0 ? worker_.finished() : worker_.wait()) == nullptr) return Outcome::kNothing;
    if (replacement_ == nullptr) return submit_clean(Outcome::kRejected);
    state_ = State::kRunningAlong;
  }
  if (state_ == State::kRunningAlong) {
    const char* reason = "";
    switch (pipeline_.warm_up(*replacement_, reason)) {
      case pipeline::Pipeline::WarmupState::kRunning:
        return Outcome::kNothing;
      case pipeline::Pipeline::WarmupState::kRejected:
        return reject(reason);
      case pipeline::Pipeline::WarmupState::kReady:
        state_ = State::kWaitingForFactor;
        refactoring.pause(true);
    }
  }
  // the present model must not be destroyed while a thread factors for it
  if (!refactoring.idle()) return Outcome::kNothing;
  return put_in(refactoring);
}

Replacing::Outcome Replacing::put_in(Refactoring& refactoring) noexcept {
  refactoring.pause(false);
  if (pipeline_.on_fallback()) return reject("a fallback runs: reset first");
  if (!pipeline_.take(*replacement_)) return reject("the present shape cannot be carried over");
  pipeline_.take(fallbacks_);
  ++replaced_;
  std::swap(root_.hash, wanted_->hash);
  std::swap(root_.node, wanted_->node);
  if (mesh_ != nullptr) telemetry_.take(mesh_);
  telemetry_.take(pipeline_);
  if (next_snapshot_ != nullptr) {
    snapshot_.positions.swap(next_snapshot_->positions);
    snapshot_.velocities.swap(next_snapshot_->velocities);
  }
  return submit_clean(Outcome::kReplaced);
}

Replacing::Outcome Replacing::reject(const char* reason) noexcept {
  bus::put_text(reason_, reason);
  return submit_clean(Outcome::kRejected);
}

Replacing::Outcome Replacing::submit_clean(Outcome outcome) noexcept {
  state_ = State::kCleaning;
  worker_.submit([](void* self) noexcept { static_cast<Replacing*>(self)->clean(); }, this);
  return outcome;
}

}  // namespace palpate::daemon
