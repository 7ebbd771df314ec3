#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <palpate/component_command_t.hpp>

#include "rt/daemon/refactoring.hpp"
#include "rt/daemon/telemetry.hpp"
#include "rt/loop/background_worker.hpp"
#include "rt/pipeline/closed_grasp.hpp"
#include "rt/pipeline/pipeline.hpp"

namespace palpate::daemon {

/// Replaces components while the loop runs, one request at a time: a separate thread constructs and
/// warms up the new components; sensor models run in parallel in the loop first; the components are
/// exchanged together between two phases of a cycle; the thread destroys the old ones. The loop
/// neither allocates nor waits.
class Replacing {
 public:
  enum class Outcome { kNothing, kReplaced, kRejected };

  /// `delay` >= 0, in deterministic mode: cycles from a request to the exchange, waiting if
  /// necessary; negative: as soon as available.
  Replacing(const config::Node& root, pipeline::Pipeline& pipeline, Telemetry& telemetry,
            bus::MessageBus& housekeeping, int delay);

  /// Accepts the event "replace" of a command; "" or the reason for immediate rejection.
  const char* request(const component_command_t& command, std::int64_t cycle) noexcept;

  /// Accepts that a hand has closed: replaces the object by one that is held where the hand holds
  /// it. False while another replacement is under way, or a fallback runs.
  bool request(const pipeline::ClosedGrasp& grasp, std::int64_t cycle) noexcept;

  /// Called once per cycle, after the sensors were read. After kRejected nothing has changed.
  Outcome service(Refactoring& refactoring, std::int64_t cycle) noexcept;

  /// The grasp of the last outcome; empty: it was a command.
  const std::optional<pipeline::ClosedGrasp>& grasp() const noexcept { return grasp_; }
  /// Command of the last outcome; of a grasp: only its slot.
  const component_command_t& command() const noexcept { return command_; }
  const char* reason() const noexcept { return reason_.data(); }
  std::int64_t configuration_hash() const noexcept { return root_.hash; }
  std::int64_t replaced() const noexcept { return replaced_; }

 private:
  enum class State { kIdle, kBuilding, kRunningAlong, kWaitingForFactor, kCleaning };

  void submit(std::int64_t cycle) noexcept;
  config::Node wanted() const;
  void build() noexcept;
  void clean() noexcept;
  Outcome reject(const char* reason) noexcept;
  Outcome put_in(Refactoring& refactoring) noexcept;
  Outcome submit_clean(Outcome outcome) noexcept;

  struct Root {
    config::Node node;
    std::int64_t hash;
  };

  pipeline::Pipeline& pipeline_;
  Telemetry& telemetry_;
  bus::MessageBus& housekeeping_;
  int delay_;
  State state_ = State::kIdle;
  std::int64_t due_ = 0;
  component_command_t command_{};
  std::optional<pipeline::ClosedGrasp> grasp_;
  std::array<char, 256> reason_{};
  std::int64_t replaced_ = 0;

  Root root_;  // configuration of the running components
  pipeline::ShapeSnapshot snapshot_;
  // created by the worker
  std::unique_ptr<Root> wanted_;
  std::unique_ptr<pipeline::Replacement> replacement_;
  std::unique_ptr<pipeline::Fallbacks> fallbacks_;
  std::unique_ptr<MeshTelemetry> mesh_;
  std::unique_ptr<pipeline::ShapeSnapshot> next_snapshot_;
  loop::BackgroundWorker worker_;
};

}  // namespace palpate::daemon
