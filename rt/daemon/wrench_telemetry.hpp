#pragma once

#include <palpate/compensated_wrench_t.hpp>
#include <vector>

#include "rt/bus/stamped_publisher.hpp"
#include "rt/pipeline/pipeline.hpp"

namespace palpate::daemon {

/// Publishes WRENCH_COMPENSATED of each arm whose wrist has a sensor model, whether or not the
/// daemon is active. Nothing allocates after construction.
class WrenchTelemetry {
 public:
  WrenchTelemetry(bus::MessageBus& control, int arms, std::int64_t session);

  /// Each cycle, after the sensors were read.
  void publish(const pipeline::Pipeline& pipeline, std::int64_t utime) noexcept;

 private:
  std::vector<bus::StampedPublisher<compensated_wrench_t>> publishers_;  // by arm
  compensated_wrench_t message_{};
};

}  // namespace palpate::daemon
