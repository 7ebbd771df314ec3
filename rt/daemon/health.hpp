#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <palpate/config_t.hpp>
#include <palpate/health_t.hpp>

#include "rt/bus/stamped_publisher.hpp"
#include "rt/daemon/inputs.hpp"
#include "rt/daemon/settings.hpp"
#include "rt/loop/latency_histogram.hpp"
#include "rt/pipeline/pipeline.hpp"

namespace palpate::daemon {

/// Implements the overrun policy: lateness within a sliding window, and time without a command. One
/// late wake-up counts as one overrun, however late.
class OverrunMonitor {
 public:
  enum class Verdict { kFine, kDegraded, kSafeStop };

  explicit OverrunMonitor(const OverrunPolicy& policy) : policy_(policy) {}

  /// Call once per cycle with wake-up time and lateness (ns). Lateness below a tenth of a period is
  /// jitter and ignored.
  Verdict record(std::int64_t now_ns, std::int64_t lateness_ns, double period) noexcept {
    const bool first = last_ns_ == 0;
    const double gap = first ? 0 : static_cast<double>(now_ns - last_ns_) * 1e-9 - period;
    last_ns_ = now_ns;
    if (static_cast<double>(lateness_ns) * 1e-9 > 0.1 * period) {
      late_[next_] = {now_ns, lateness_ns};
      next_ = (next_ + 1) % late_.size();
    }
    if (gap >= policy_.safe_stop_after) return Verdict::kSafeStop;
    double sum = 0;
    for (const Late& late : late_) {
      if (static_cast<double>(now_ns - late.at_ns) * 1e-9 <= policy_.window) {
        sum += static_cast<double>(late.by_ns) * 1e-9;
      }
    }
    return sum >= policy_.degraded_after ? Verdict::kDegraded : Verdict::kFine;
  }

 private:
  struct Late {
    std::int64_t at_ns = -(std::int64_t{1} << 62);
    std::int64_t by_ns = 0;
  };
  OverrunPolicy policy_;
  std::array<Late, 64> late_{};
  std::size_t next_ = 0;
  std::int64_t last_ns_ = 0;
};

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
  std::int64_t gate_rejected = 0;
  std::int64_t commands_rejected = 0;
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
  bool has_new_data(const pipeline::Condition& condition, const Inputs& inputs,
                    std::int64_t now_ns) noexcept;
  /// Sets the content of CONFIG.
  void describe(std::int64_t configuration_hash, std::int64_t mesh_hash) noexcept;
  void publish_config(std::int64_t utime) noexcept { config_.publish(config_message_, utime); }

 private:
  const bus::MessageBus& control_;
  const bus::MessageBus& housekeeping_;
  bus::StampedPublisher<health_t> health_;
  bus::StampedPublisher<config_t> config_;
  std::int64_t news_ns_ = 0;    // time of the last important change
  std::int64_t troubles_ = -1;  // losses and rejections of inputs at that time
  health_t message_{};
  config_t config_message_{};
};

}  // namespace palpate::daemon
