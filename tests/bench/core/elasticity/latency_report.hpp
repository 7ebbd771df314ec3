#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "tests/bench/core/elasticity/latency_run.hpp"

namespace palpate::bench {

struct LatencyRow {
  LatencyOptions options;
  LatencyResult result;
};

/// One line per configuration, and one for each of its baselines; times in ms.
void print_latency(const std::vector<LatencyRow>& rows, std::ostream& out);
nlohmann::json to_json(const LatencyRow& row);

}  // namespace palpate::bench
