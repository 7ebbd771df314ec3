#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "rt/loop/latency_histogram.hpp"

namespace palpate::endurance {

/// What a part of the cycles of a loop took of the processor.
struct CycleCost {
  int nodes = 0;  // of the mesh
  loop::LatencyHistogram estimator, jacobian, program, together;
  std::int64_t factors = 0;      // that were taken from the background thread meanwhile
  std::int64_t allocations = 0;  // of the three parts in the loop's thread
};

/// Runs estimator, Jacobian (feature and provider) and law of a configuration in a closed loop
/// whose hand does what the law says and whose wrench is the model's own with noise, to and fro
/// between two targets; factors are made in a background thread, as in palpated. Time is that of
/// the processor in this thread, so that what else runs on the machine counts by its use of caches
/// alone. Throws config::Error.
CycleCost measure_cycle_cost(const std::filesystem::path& configuration,
                             const std::vector<std::string>& overrides, int cycles);

struct CycleCostOptions {
  int cycles = 20000;                  // measured of each mesh
  std::filesystem::path root;          // source tree
  std::filesystem::path json;          // summary; empty: none
  std::vector<std::string> overrides;  // of the configuration
};

/// Of boxes with about 150, 300, 500 and 700 quadratic nodes, with the filter of pose and wrench
/// and every limit: prints a table. 1 where anything was allocated.
int run_cycle_cost(const CycleCostOptions& options, std::ostream& out);

}  // namespace palpate::endurance
