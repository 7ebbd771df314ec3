#include "rt/registry/inference_settings.hpp"

#include <algorithm>

#include "rt/loop/fixed_rate_loop.hpp"

namespace palpate::registry {

InferenceSettings read_inference(const config::Node& root, bool deterministic) {
  const int loop_priority = root.child_or_empty("loop").integer("fifo_priority", {0, 98},
                                                                loop::LoopOptions().fifo_priority);
  const config::Node node =
      root.child_or_empty({"inference", "", "threads that run learned models"});
  InferenceSettings settings;
  settings.priority = node.integer(
      {"priority", "", "SCHED_FIFO priority of the inference threads; 0: ordinary scheduling"},
      {0, 98}, std::max(0, loop_priority - 1));
  settings.cpu = node.integer({"cpu", "", "processor that they are bound to; -1: any"}, {-1, 1023},
                              settings.cpu);
  return deterministic ? InferenceSettings{} : settings;
}

}  // namespace palpate::registry
