#pragma once

#include <array>
#include <palpate/config_t.hpp>
#include <palpate/health_t.hpp>

#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"
#include "rt/daemon/inputs.hpp"
#include "rt/loop/latency_histogram.hpp"
#include "rt/pipeline/pipeline.hpp"

namespace palpate::daemon {

/// Phases of a cycle in the order of health_t; kAll is the whole cycle, kWakeUp the wake-up
/// latency.
enum class Phase {
  kAll,
  kRead,
  kSensing,
  kContact,
  kEstimation,
  kFeature,
  kControl,
  kGate,
  kPublish,
  kWakeUp,
};
inline constexpr int kPhases = 10;
const char* name(Phase phase) noexcept;

/// Counters published in HEALTH.
struct Counters {
  std::int64_t cycles = 0;
  std::int64_t overruns = 0;
  std::int64_t overrun_ns = 0;
  std::int64_t shapes_not_converged = 0;
  std::int64_t page_faults = 0;
  std::int64_t allocations = -1;
  std::int64_t gate_limited = 0;
  std::int64_t gate_refused = 0;
  std::int64_t commands_refused = 0;
  std::array<loop::LatencyHistogram, kPhases> latency;
};

/// Publishes HEALTH (10 Hz, and immediately after an important change) and CONFIG (1 Hz) on the
/// housekeeping bus.
class Health {
 public:
  /// Reports the losses of both buses; publishes on the second one.
  Health(const bus::MessageBus& control, bus::MessageBus& housekeeping, std::int64_t session,
         std::int64_t configuration_hash, std::int64_t mesh_hash);
  void publish(const Counters& counters, const pipeline::Condition& condition, const Inputs& inputs,
               const std::vector<pipeline::RunningModel>& models, std::int64_t utime) noexcept;
  /// Called once per cycle: whether a change must be published before the next regular message: a
  /// different state, or a loss or rejected message after a period without any. Rate-limited, so
  /// that alternating conditions do not cause a message flood.
  bool has_news(const pipeline::Condition& condition, const Inputs& inputs,
                std::int64_t now_ns) noexcept;
  /// Sets the content of CONFIG.
  void describe(std::int64_t configuration_hash, std::int64_t mesh_hash) noexcept;
  void publish_config(std::int64_t utime) noexcept;

 private:
  const bus::MessageBus& control_;
  const bus::MessageBus& housekeeping_;
  bus::HeaderStamper health_stamp_, config_stamp_;
  bus::TypedPublisher<health_t> health_;
  bus::TypedPublisher<config_t> config_;
  std::int64_t news_ns_ = 0;    // time of the last important change
  std::int64_t troubles_ = -1;  // losses and rejections of inputs at that time
  health_t message_{};
  config_t config_message_{};
};

}  // namespace palpate::daemon
