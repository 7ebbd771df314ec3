#pragma once

#include "tools/common/plot.hpp"
#include "tools/lab/cases/case_mesh.hpp"
#include "tools/lab/cases/case_score.hpp"

namespace palpate::cases {

/// One case over a ladder of mesh sizes with one element: error against time per tick.
struct SweepOptions {
  int ticks = 200;               // of the rise of the load, for the times
  int most_linear = 2000;        // nodes
  int most_quadratic = 1300;     // nodes
  int goal_nodes = 600;          // one quadratic mesh of at most so many ...
  double goal_rms_share = 0.02;  // ... should stay within this
};

/// Grids over the box that holds the body: 1, 2, ... cells across its smallest side, cells up to
/// twice as long as wide, even ones and ones graded towards the clamp, at most `most` nodes.
std::vector<CaseGrid> grid_ladder(const CaseFile& c, mesh::ElementOrder order, int most);

/// Scores of all grids; for a body that is not made of boxes of the meshes that come with the case.
std::vector<CaseScore> sweep(const CaseFile& c, mesh::ElementOrder order,
                             const SweepOptions& options);

/// Of the quadratic meshes within the goal the one with the fewest nodes, and of those with few
/// enough nodes the most accurate; nullptr where there is none.
const CaseScore* smallest_within_goal(const std::vector<CaseScore>& scores,
                                      const SweepOptions& options);
const CaseScore* most_accurate(const std::vector<CaseScore>& scores, const SweepOptions& options);

/// Those that no other one beats in both median time and error, by rising time.
std::vector<const CaseScore*> best_of(const std::vector<CaseScore>& scores,
                                      mesh::ElementOrder order);

/// Error in % against median time per tick, a curve for each element.
common::Plot error_against_time(const std::string& name, const std::vector<CaseScore>& scores);

}  // namespace palpate::cases
