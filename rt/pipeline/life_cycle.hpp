#pragma once

#include <cstdio>

#include "core/sensing/sensor_model.hpp"

namespace palpate::pipeline {

/// One life-cycle for every component; numbers are those of health_t.state.
enum class LifeCycle {
  kUnconfigured = 0,
  kInactive = 1,  // configured, not updated; the daemon's state at every start
  kActive = 2,
  kDegraded = 3,  // an input is old or late; recovers by itself
  kFaulted = 4,   // latched until reset
  kFinalized = 5,
};

/// Events that a user sends; the thesis' names.
enum class Event { kStart, kStop, kReset, kZero, kCalibrate, kReplace, kUnknown };

const char* name(LifeCycle state) noexcept;
const char* name(Event event) noexcept;

/// kUnknown where the text is none of the names.
Event event_from(const char* text) noexcept;

/// State and the reason for it, of one slot or of the whole.
struct Condition {
  LifeCycle state = LifeCycle::kUnconfigured;
  const char* reason = "";     // a string literal
  const char* component = "";  // name of the instance that is so; "" where it is the whole

  /// Takes over the outcome of an update: kFault latches, kDegraded passes.
  void apply(const sensing::UpdateResult& result) noexcept;
};

/// The reason of a condition, with the component that is in it where one is.
template <std::size_t kSize>
void put_reason(const Condition& condition, char (&text)[kSize]) noexcept {
  const char* separator = *condition.component != '\0' && *condition.reason != '\0' ? ": " : "";
  std::snprintf(text, kSize, "%s%s%s", *separator != '\0' ? condition.component : "", separator,
                condition.reason);
}

}  // namespace palpate::pipeline
