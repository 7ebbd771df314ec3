#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <vector>

#include "tests/bench/core/elasticity/latency_report.hpp"

namespace palpate::bench {

/// One part of a step compared with the shortest time possible on the machine.
struct StepPart {
  std::string name;
  double times = 0;  // per step, mean
  double work = 0;   // of one call: flops, or bytes that must be read
  bool is_flops = false;
  double floor = 0;     // s, `work` over the machine's peak; 0: unknown
  double measured = 0;  // s, one call, alone with warm caches; of "the rest" by difference
};

struct FloorReport {
  std::string mesh;
  std::vector<StepPart> parts;  // the last one is the rest of the step
  double step = 0;              // s, p50 of the thread's time for a step of the run
  double floor() const;         // s, of a step
};

/// Measures the parts of a step of `row`'s run on one core. Evaluations (a pass over the elements
/// and one over the masses) count once per correction and once before.
FloorReport find_floor(const LatencyRow& row);

/// Times in us, and the ratio of each part to its floor.
void print_floors(const std::vector<FloorReport>& reports, std::ostream& out);
nlohmann::json to_json(const FloorReport& report);

}  // namespace palpate::bench
