#pragma once

#include "rt/bus/message_bus.hpp"
#include "rt/daemon/commands.hpp"
#include "rt/daemon/component_reports.hpp"
#include "rt/daemon/crash_record.hpp"
#include "rt/daemon/health.hpp"
#include "rt/daemon/inputs.hpp"
#include "rt/daemon/refactoring.hpp"
#include "rt/daemon/replacing.hpp"
#include "rt/daemon/settings.hpp"
#include "rt/daemon/telemetry.hpp"
#include "rt/daemon/touching.hpp"
#include "rt/pipeline/pipeline.hpp"

namespace palpate::daemon {

/// Real time: message times from the wall clock, measured latencies, factorisation in a background
/// thread. Deterministic: all of these follow from the cycle count and the inputs.
enum class Mode { kRealTime, kDeterministic };

/// Reading of the clock that drives the daemon.
struct Now {
  std::int64_t monotonic_ns = 0;  // CLOCK_MONOTONIC, or virtual
  std::int64_t utime = 0;         // us, for messages
  std::int64_t lateness_ns = 0;   // ns, of this wake-up
  /// Periods without a cycle, because the previous cycle took too long.
  std::int64_t missed = 0;
  bool stepped = false;  // messages count as arrived now, whatever their actual arrival
};

/// All of palpated except its threads and its clock: input messages, pipeline, output messages. The
/// same class runs in palpated, in palpate-replay and in tests.
class Daemon {
 public:
  /// Sets the configured names of channels on both buses, and subscribes; call start() of both
  /// afterwards. Throws config::Error.
  Daemon(const config::Node& root, bus::MessageBus& control, bus::MessageBus& housekeeping,
         Mode mode, std::int64_t session);

  /// Runs one cycle. Neither allocates, locks, logs nor throws.
  void tick(const Now& now) noexcept;

  /// True if no arm is commanded to move.
  bool is_still() const noexcept;

  /// Publishes a zero command before the process ends.
  void finish(const Now& now) noexcept;

  const Settings& settings() const noexcept { return settings_; }
  pipeline::Pipeline& pipeline() noexcept { return pipeline_; }
  const pipeline::Pipeline& pipeline() const noexcept { return pipeline_; }
  const Counters& counters() const noexcept { return counters_; }
  const Replacing& replacing() const noexcept { return replacing_; }
  const Inputs& inputs() const noexcept { return inputs_; }
  /// nullptr if disabled: in deterministic mode, or without a folder.
  CrashRecord* crash_record() noexcept { return record_.get(); }
  bool take_record(EventRecord& record) noexcept { return commands_.take_record(record); }

 private:
  void supervise(const Now& now) noexcept;
  void mark(Phase phase) noexcept;
  void replace(const Now& now) noexcept;
  void publish(const Now& now) noexcept;
  void report_jump(const Now& now) noexcept;

  Mode mode_;
  Settings settings_;
  bus::Access access_;
  std::unique_ptr<CrashRecord> record_;
  pipeline::Pipeline pipeline_;
  Inputs inputs_;
  Commands commands_;
  Touching touching_;
  ComponentReports reports_;
  Telemetry telemetry_;
  Health health_;
  Refactoring refactoring_;
  Replacing replacing_;
  TypeWatch types_;
  OverrunMonitor overruns_;
  Counters counters_;
  pipeline::LifeCycle announced_ = pipeline::LifeCycle::kUnconfigured;
  bool woke_late_ = false;  // in the previous cycle
  int reported_fallbacks_ = 0;
  std::int64_t phase_began_ns_ = 0;
  std::int64_t shape_ns_ = 0;  // time of the last update of the shape
  std::int64_t jump_reported_ns_ = 0;
  std::int64_t faults_at_start_ = 0;
  std::int64_t allocations_at_start_ = 0;
};

}  // namespace palpate::daemon
