#include "tools/lab/cases/case_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "tools/lab/cases/case_report.hpp"

namespace palpate::cases {
namespace {

using mesh::ElementOrder;

Eigen::Vector3d extent(const CaseFile& c) {
  Eigen::AlignedBox3d body;
  for (const Eigen::AlignedBox3d& box : c.boxes) body.extend(box);
  return body.sizes();
}

bool fits(const CaseScore& score, const SweepOptions& options) {
  return score.order == ElementOrder::kQuadratic && score.nodes <= options.goal_nodes &&
         score.converged();
}

}  // namespace

std::vector<CaseGrid> grid_ladder(const CaseFile& c, ElementOrder order, int most) {
  const Eigen::Vector3d size = extent(c);
  const int points = order == ElementOrder::kLinear ? 1 : 2;  // of a cell along each axis
  std::set<std::array<int, 3>> ladder;
  for (int across = 1; across <= 8; ++across) {
    for (const double stretch : {1.0, 2.0}) {
      std::array<int, 3> cells{};
      long nodes = 1;
      for (int axis = 0; axis < 3; ++axis) {
        const double cubes = size[axis] * across / size.minCoeff();
        const bool is_long = size[axis] > 1.5 * size.minCoeff();
        cells[axis] = std::max(1, static_cast<int>(std::lround(is_long ? cubes / stretch : cubes)));
        nodes *= points * cells[axis] + 1;
      }
      if (nodes <= most) ladder.insert(cells);
    }
  }
  std::vector<CaseGrid> grids;
  for (const auto& cells : ladder)
    for (const double grading : {1.0, 2.0}) grids.push_back({cells, mesh::CellCut::kFive, grading});
  return grids;
}

std::vector<CaseScore> sweep(const CaseFile& c, ElementOrder order, const SweepOptions& options) {
  const ScoreCaseOptions scoring{options.ticks, {}};
  std::vector<CaseScore> scores;
  if (c.boxes.empty()) {
    for (const auto& [name, file] : c.meshes)
      scores.push_back(score_case(c, name, read_case_mesh(c, name), order, scoring));
    return scores;
  }
  const int most = order == ElementOrder::kLinear ? options.most_linear : options.most_quadratic;
  for (const CaseGrid& grid : grid_ladder(c, order, most))
    scores.push_back(score_case(c, grid.text(), make_case_mesh(c, grid), order, scoring));
  std::stable_sort(scores.begin(), scores.end(),
                   [](const CaseScore& a, const CaseScore& b) { return a.nodes < b.nodes; });
  return scores;
}

const CaseScore* smallest_within_goal(const std::vector<CaseScore>& scores,
                                      const SweepOptions& options) {
  const CaseScore* best = nullptr;
  for (const CaseScore& score : scores) {
    if (!fits(score, options) || !(score.figures.rms_share() <= options.goal_rms_share)) continue;
    if (best == nullptr || score.nodes < best->nodes) best = &score;
  }
  return best;
}

const CaseScore* most_accurate(const std::vector<CaseScore>& scores, const SweepOptions& options) {
  const CaseScore* best = nullptr;
  for (const CaseScore& score : scores) {
    if (!fits(score, options)) continue;
    if (best == nullptr || score.figures.probe_rms < best->figures.probe_rms) best = &score;
  }
  return best;
}

std::vector<const CaseScore*> best_of(const std::vector<CaseScore>& scores, ElementOrder order) {
  std::vector<const CaseScore*> sorted;
  for (const CaseScore& score : scores)
    if (score.order == order && score.incremental && score.converged()) sorted.push_back(&score);
  std::sort(sorted.begin(), sorted.end(), [](const CaseScore* a, const CaseScore* b) {
    return a->incremental->times.p50 < b->incremental->times.p50;
  });
  std::vector<const CaseScore*> best;
  for (const CaseScore* score : sorted)
    if (best.empty() || score->figures.probe_rms < best.back()->figures.probe_rms)
      best.push_back(score);
  return best;
}

common::Plot error_against_time(const std::string& name, const std::vector<CaseScore>& scores) {
  common::Plot plot;
  plot.title = name;
  plot.x_label = "median time per 1 ms tick, us";
  plot.y_label = "RMS error, % of largest displacement";
  plot.logarithmic = true;
  for (const ElementOrder order : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    common::Curve curve;
    curve.title = name_of(order);
    for (const CaseScore* score : best_of(scores, order)) {
      curve.x.push_back(score->incremental->times.p50);
      curve.y.push_back(100 * score->figures.rms_share());
    }
    if (!curve.x.empty()) plot.curves.push_back(std::move(curve));
  }
  return plot;
}

}  // namespace palpate::cases
