#pragma once

#include "tools/common/plot.hpp"
#include "tools/lab/cases/case_mesh.hpp"
#include "tools/lab/cases/case_score.hpp"

namespace palpate::cases {

/// One case over a series of mesh sizes with one element: error against time per tick.
struct SweepOptions {
  int ticks = 200;               // of the load ramp, for the times
  int most_linear = 2000;        // nodes
  int most_quadratic = 1300;     // nodes
  int goal_nodes = 600;          // a quadratic mesh of at most this many nodes ...
  double goal_rms_share = 0.02;  // ... should stay within this
};

/// Grids over the body's bounding box: 1, 2, ... cells across its smallest side, cells up to twice
/// as long as wide, uniform ones and ones graded towards the clamp, at most `most` nodes.
std::vector<CaseGrid> grid_ladder(const CaseFile& c, mesh::ElementOrder order, int most);

/// Scores of all grids; for a body that is not made of boxes, of the meshes supplied with the case.
std::vector<CaseScore> sweep(const CaseFile& c, mesh::ElementOrder order,
                             const SweepOptions& options);

/// Of the quadratic meshes within the goal the one with the fewest nodes, and of those with few
/// enough nodes the most accurate; nullptr if there is none.
const CaseScore* smallest_within_goal(const std::vector<CaseScore>& scores,
                                      const SweepOptions& options);
const CaseScore* most_accurate(const std::vector<CaseScore>& scores, const SweepOptions& options);

/// The Pareto front of median time and error, by ascending time.
std::vector<const CaseScore*> best_of(const std::vector<CaseScore>& scores,
                                      mesh::ElementOrder order);

/// Error in % against median time per tick, one curve per element.
common::Plot error_against_time(const std::string& name, const std::vector<CaseScore>& scores);

}  // namespace palpate::cases
