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

/// Phases of a cycle in the order of health_t; kAll is the whole cycle, kWakeUp the lateness.
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

/// Everything that HEALTH counts.
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

/// HEALTH (10 Hz, and at once where it has news) and CONFIG (1 Hz) on the housekeeping bus.
class Health {
 public:
  /// Tells of both buses what they lost; publishes on the second one.
  Health(const bus::MessageBus& control, bus::MessageBus& housekeeping, std::int64_t session,
         std::int64_t configuration_hash, std::int64_t mesh_hash);
  void publish(const Counters& counters, const pipeline::Condition& condition, const Inputs& inputs,
               const std::vector<pipeline::RunningModel>& models, std::int64_t utime) noexcept;
  /// Asked once a cycle: whether there is something to tell that must not wait for the next regular
  /// message: another state, or a loss or a refused message after a while without. Seldom enough
  /// that whatever comes and goes cannot flood anybody.
  bool has_news(const pipeline::Condition& condition, const Inputs& inputs,
                std::int64_t now_ns) noexcept;
  /// What CONFIG says from now on.
  void describe(std::int64_t configuration_hash, std::int64_t mesh_hash) noexcept;
  void publish_config(std::int64_t utime) noexcept;

 private:
  const bus::MessageBus& control_;
  const bus::MessageBus& housekeeping_;
  bus::Stamp health_stamp_, config_stamp_;
  bus::TypedPublisher<health_t> health_;
  bus::TypedPublisher<config_t> config_;
  std::int64_t news_ns_ = 0;    // when there was some
  std::int64_t troubles_ = -1;  // of inputs, by then
  health_t message_{};
  config_t config_message_{};
};

}  // namespace palpate::daemon
