#pragma once

#include <array>
#include <cstdint>

#include "rt/daemon/commands.hpp"

namespace palpate::daemon {

/// Publishes state changes of components with their reason by COMPONENT_EVENT, at most ten times
/// per second for each instance of the sensing slot; a fault, of the instance or of a model that it
/// runs, is published at once. So is, at most ten times per second, a change of what control does
/// about wrenches that contradict the model: slowed, stopped, resumed.
class ComponentReports {
 public:
  explicit ComponentReports(const pipeline::Pipeline& pipeline) { begin(pipeline); }

  /// Restarts after components have been replaced.
  void begin(const pipeline::Pipeline& pipeline) noexcept;

  /// Called once per cycle; neither allocates nor throws.
  void service(const pipeline::Pipeline& pipeline, Commands& commands, std::int64_t now_ns,
               std::int64_t utime) noexcept;

 private:
  struct Reported {
    pipeline::Condition condition{pipeline::LifeCycle::kInactive, ""};
    std::int64_t ns = 0;
    std::array<std::int64_t, 2> faults{};  // by model of the instance
  };

  static void report_faults(const pipeline::SensorReport& report, Reported& reported,
                            Commands& commands, std::int64_t utime) noexcept;
  void report_control(const pipeline::Pipeline& pipeline, Commands& commands, std::int64_t now_ns,
                      std::int64_t utime) noexcept;

  std::array<Reported, pipeline::ComponentSet::kMostSensors> reported_;  // by instance
  control::DiscrepancyAction action_ = control::DiscrepancyAction::kContinue;
  std::int64_t action_ns_ = 0;
};

}  // namespace palpate::daemon
