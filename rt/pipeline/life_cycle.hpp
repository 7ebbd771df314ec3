#pragma once

#include <cstdio>

#include "core/sensing/sensor_model.hpp"

namespace palpate::pipeline {

/// Life-cycle of every component; values as in health_t.state.
enum class LifeCycle {
  kUnconfigured = 0,
  kInactive = 1,  // configured, not updated; initial state of the daemon
  kActive = 2,
  kDegraded = 3,  // an input is stale or late; recovers automatically
  kFaulted = 4,   // latched until reset
  kFinalized = 5,
};

/// Events sent by users, named as in Sanchez 2019.
enum class Event { kStart, kStop, kReset, kZero, kCalibrate, kReplace, kUnknown };

const char* name(LifeCycle state) noexcept;
const char* name(Event event) noexcept;

/// kUnknown if the text is not one of the names.
Event event_from(const char* text) noexcept;

/// State of a slot or of the whole pipeline, and its reason.
struct Condition {
  LifeCycle state = LifeCycle::kUnconfigured;
  const char* reason = "";     // a string literal, or a text of the pipeline
  const char* component = "";  // name of the instance concerned; "" for the whole pipeline

  /// Applies the outcome of an update: kFault latches, kDegraded and kDoubtful do not.
  void apply(const UpdateResult& result) noexcept;
};

/// Writes the reason of a condition, with the component concerned if there is one.
template <std::size_t kSize>
void put_reason(const Condition& condition, char (&text)[kSize]) noexcept {
  const char* separator = *condition.component != '\0' && *condition.reason != '\0' ? ": " : "";
  std::snprintf(text, kSize, "%s%s%s", *separator != '\0' ? condition.component : "", separator,
                condition.reason);
}

}  // namespace palpate::pipeline
