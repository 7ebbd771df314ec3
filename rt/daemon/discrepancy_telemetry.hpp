#pragma once

#include <palpate/discrepancy_t.hpp>

#include "core/estimation/discrepancy_report.hpp"
#include "rt/bus/message_bus.hpp"
#include "rt/bus/session.hpp"

namespace palpate::daemon {

/// Publishes DISCREPANCY once per test of the wrenches' consistency. Nothing allocates after
/// construction.
class DiscrepancyTelemetry {
 public:
  DiscrepancyTelemetry(bus::MessageBus& control, std::int64_t session);

  /// Each cycle; publishes if the number of tests has changed. `report`: nullptr if the estimator
  /// has no test. `grasp_count`: 0 to 2.
  void publish(const estimation::DiscrepancyReport* report, int grasp_count,
               std::int64_t utime) noexcept;

 private:
  void put_explanations(const estimation::DiscrepancyReport& report) noexcept;

  bus::HeaderStamper stamp_;
  bus::TypedPublisher<discrepancy_t> publisher_;
  discrepancy_t message_{};
  std::int64_t published_ = 0;  // number of tests
};

}  // namespace palpate::daemon
