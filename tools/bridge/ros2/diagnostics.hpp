#pragma once

#include <functional>
#include <palpate/component_event_t.hpp>
#include <palpate/health_t.hpp>
#include <string>
#include <utility>
#include <vector>

#include "participant.hpp"
#include "rt/bus/message_bus.hpp"

namespace palpate::ros2_bridge {

/// One entry of diagnostic_msgs/DiagnosticArray.
struct Diagnosis {
  enum Level : std::uint8_t { kOk = 0, kWarning = 1, kError = 2, kStale = 3 };
  Level level = kOk;
  std::string name, message;
  std::vector<std::pair<std::string, std::string>> values;
};

/// HEALTH in words: state, reason, cycles and the inputs.
Diagnosis diagnose(const health_t& health);
/// An event of a slot: faults are errors; refusals and degradations are warnings.
Diagnosis diagnose(const component_event_t& event);

/// palpated's HEALTH once a second, its absence, its events at once, and this program's counters.
class Diagnostics {
 public:
  using Counters = std::function<std::vector<std::pair<std::string, std::string>>()>;

  Diagnostics(const Participant& participant, const std::string& topic,
              bus::MessageBus& housekeeping, Counters counters);

  void cycle(std::int64_t now_us);

 private:
  void publish(std::vector<Diagnosis> all, std::int64_t now_us);

  bus::TypedSubscription<health_t> healths_;
  bus::TypedSubscription<component_event_t> events_;
  Counters counters_;
  health_t health_{};
  std::int64_t heard_us_ = 0, sent_us_ = 0;
  Writer<DiagnosticArray> writer_;
};

}  // namespace palpate::ros2_bridge
