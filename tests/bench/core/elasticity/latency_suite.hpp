#pragma once

#include "tests/bench/core/elasticity/latency_report.hpp"

namespace palpate::bench {

/// The configurations with performance goals: quadratic 475 and 1225, linear 1008 and 2997 nodes in
/// motion L, two iterations, with baselines; and quadratic 475 with each hyperelastic law. Other
/// options as in `common`, except its threads, which apply only to the last.
std::vector<LatencyOptions> suite_of_goals(LatencyOptions common);

/// Every size of both elements, with baselines, at most half a minute each. Other options as in
/// `common`.
std::vector<LatencyOptions> suite_of_sizes(LatencyOptions common);

/// Time per step against nodes, p50 and p99 of the model and p50 of the baselines, to a PNG or SVG.
void draw_scaling(const std::vector<LatencyRow>& rows, const std::string& png);

}  // namespace palpate::bench
