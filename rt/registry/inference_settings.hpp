#pragma once

#include <string>
#include <vector>

#include "rt/config/node.hpp"

namespace palpate::registry {

/// Section `inference`: settings of the threads that run learned models.
struct InferenceSettings {
  int priority = 0;  // SCHED_FIFO; 0: SCHED_OTHER
  int cpu = -1;      // processor affinity; -1: any
};

/// Keys priority (0 to 98, default one below the loop's) and cpu (-1 to 1023). Both are ignored in
/// deterministic mode, which has no deadlines. Throws config::Error.
InferenceSettings read_inference(const config::Node& root, bool deterministic);

}  // namespace palpate::registry
