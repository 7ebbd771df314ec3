#include "rt/pipeline/life_cycle.hpp"

#include <array>
#include <cstring>

namespace palpate::pipeline {
namespace {

constexpr std::array<const char*, 6> kStateNames = {"unconfigured", "inactive", "active",
                                                    "degraded",     "faulted",  "finalized"};
constexpr std::array<const char*, 7> kEventNames = {"start",     "stop",    "reset",  "zero",
                                                    "calibrate", "replace", "unknown"};

}  // namespace

const char* name(LifeCycle state) noexcept { return kStateNames[static_cast<int>(state)]; }

const char* name(Event event) noexcept { return kEventNames[static_cast<int>(event)]; }

Event event_from(const char* text) noexcept {
  for (int i = 0; i < static_cast<int>(Event::kUnknown); ++i) {
    if (std::strcmp(text, kEventNames[i]) == 0) return static_cast<Event>(i);
  }
  return Event::kUnknown;
}

void Condition::apply(const UpdateResult& result) noexcept {
  if (state != LifeCycle::kActive && state != LifeCycle::kDegraded) return;
  switch (result.status) {
    case Status::kOk:
      state = LifeCycle::kActive;
      break;
    case Status::kDegraded:
    case Status::kDoubtful:
      state = LifeCycle::kDegraded;
      break;
    case Status::kFault:
      state = LifeCycle::kFaulted;
      break;
  }
  reason = result.reason;
}

}  // namespace palpate::pipeline
