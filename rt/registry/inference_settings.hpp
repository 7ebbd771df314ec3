#pragma once

#include <string>
#include <vector>

#include "rt/config/node.hpp"

namespace palpate::registry {

/// Section `inference`: of the threads that run learned models.
struct InferenceSettings {
  int priority = 0;  // SCHED_FIFO; 0: they stay SCHED_OTHER
  int cpu = -1;      // -1: any
};

/// Keys priority (0 to 98, by default one below the loop's) and cpu (-1 to 1023). In deterministic
/// mode nobody is in a hurry, and neither is taken. Throws config::Error.
InferenceSettings read_inference(const config::Node& root, bool deterministic);

}  // namespace palpate::registry
