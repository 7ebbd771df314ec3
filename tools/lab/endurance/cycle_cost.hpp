#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "rt/loop/latency_histogram.hpp"

namespace palpate::endurance {

/// Processor time of one part of a loop's cycles.
struct CycleCost {
  int nodes = 0;  // of the mesh
  loop::LatencyHistogram estimator, jacobian, program, together;
  std::int64_t factors = 0;      // factors taken over from the background thread meanwhile
  std::int64_t allocations = 0;  // of the three parts in the loop's thread
};

/// Runs estimator, Jacobian (feature and provider) and controller of a configuration in a closed
/// loop whose hand follows the controller and whose wrench is the model's own plus noise,
/// alternating between two targets; factorisations run in a background thread, as in palpated.
/// Measures the processor time of this thread, so that other load on the machine matters only
/// through the caches. Throws config::Error.
CycleCost measure_cycle_cost(const std::filesystem::path& configuration,
                             const std::vector<std::string>& overrides, int cycles);

struct CycleCostOptions {
  int cycles = 20000;                  // measured on each mesh
  std::filesystem::path root;          // source tree
  std::filesystem::path json;          // summary; empty: none
  std::vector<std::string> overrides;  // of the configuration
};

/// Runs boxes with about 150, 300, 500 and 700 quadratic nodes, with the pose-and-wrench filter and
/// every limit: prints a table. Returns 1 if anything was allocated.
int run_cycle_cost(const CycleCostOptions& options, std::ostream& out);

}  // namespace palpate::endurance
