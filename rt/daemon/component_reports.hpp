#pragma once

#include <array>
#include <cstdint>

#include "rt/daemon/commands.hpp"

namespace palpate::daemon {

/// Tells by COMPONENT_EVENT whose state changed and why, at most ten times a second for each
/// instance of the sensing slot; a fault, of it or of a model that it runs, is told at once.
class ComponentReports {
 public:
  explicit ComponentReports(const pipeline::Pipeline& pipeline) { begin(pipeline); }

  /// Afresh, after components have been replaced.
  void begin(const pipeline::Pipeline& pipeline) noexcept;

  /// Once a cycle; neither allocates nor throws.
  void service(const pipeline::Pipeline& pipeline, Commands& commands, std::int64_t now_ns,
               std::int64_t utime) noexcept;

 private:
  struct Told {
    pipeline::Condition condition{pipeline::LifeCycle::kInactive, ""};
    std::int64_t ns = 0;
    std::array<std::int64_t, 2> faults{};  // by model that the instance runs
  };

  static void tell_faults(const pipeline::SensorReport& report, Told& told, Commands& commands,
                          std::int64_t utime) noexcept;
  std::array<Told, pipeline::Slots::kMostSensors> told_;  // by instance
};

}  // namespace palpate::daemon
