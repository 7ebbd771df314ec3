#pragma once

#include "tests/bench/core/elasticity/latency_report.hpp"

namespace palpate::bench {

/// The configurations that goals are set for: quadratic 475 and 1225, linear 1008 and 2997 nodes in
/// motion L, two iterations, with baselines. The rest as in `common`, but for its threads, which
/// only the last takes.
std::vector<LatencyOptions> suite_of_goals(LatencyOptions common);

/// Every size of both elements, with baselines, at most half a minute each. The rest as in
/// `common`.
std::vector<LatencyOptions> suite_of_sizes(LatencyOptions common);

/// Time per step against nodes, p50 and p99 of the model and p50 of the baselines, to a PNG or SVG.
/// False where gnuplot is not installed.
bool draw_scaling(const std::vector<LatencyRow>& rows, const std::string& png);

}  // namespace palpate::bench
