#include "tests/bench/core/elasticity/latency_suite.hpp"

#include <algorithm>

#include "tools/common/plot.hpp"

namespace palpate::bench {

std::vector<LatencyOptions> suite_of_goals(LatencyOptions common) {
  using mesh::ElementOrder;
  common.motion = Motion::kLarge;
  common.solver.iterations = 2;
  common.baselines = true;
  std::vector<LatencyOptions> suite;
  for (const auto& [order, nodes] : {std::pair{ElementOrder::kQuadratic, 475},
                                     {ElementOrder::kQuadratic, 1225},
                                     {ElementOrder::kLinear, 1008},
                                     {ElementOrder::kLinear, 2997}}) {
    common.mesh = bar_of(order, nodes);
    suite.push_back(common);
    if (nodes != 2997) suite.back().solver.team = nullptr;
  }
  LatencyOptions large_strain = suite.front();
  large_strain.baselines = false;
  large_strain.checks = 0;
  for (const auto& law : elasticity::stretch_laws()) {
    large_strain.law = law.name;
    suite.push_back(large_strain);
  }
  return suite;
}

std::vector<LatencyOptions> suite_of_sizes(LatencyOptions common) {
  common.baselines = true;
  common.seconds = std::min(common.seconds, 30.0);
  std::vector<LatencyOptions> suite;
  for (const auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    for (const BarMesh& mesh : bar_meshes(order)) {
      common.mesh = mesh;
      suite.push_back(common);
    }
  }
  return suite;
}

void draw_scaling(const std::vector<LatencyRow>& rows, const std::string& png) {
  common::Plot plot;
  plot.title = "Time per step of 1 ms, motion " + letter_of(rows.front().options.motion);
  plot.x_label = "nodes";
  plot.y_label = "ms";
  plot.logarithmic = plot.logarithmic_x = true;
  for (const auto order : {mesh::ElementOrder::kLinear, mesh::ElementOrder::kQuadratic}) {
    const std::string name = order == mesh::ElementOrder::kLinear ? "linear" : "quadratic";
    common::Curve p50{name + " p50", {}, {}, false}, p99{name + " p99", {}, {}, true};
    common::Curve cholmod{name + " full CHOLMOD", {}, {}, false};
    common::Curve pcg{name + " Jacobi-PCG", {}, {}, false};
    std::vector<const LatencyRow*> sorted;
    for (const LatencyRow& row : rows) {
      if (row.options.mesh.order == order && row.options.law.empty()) sorted.push_back(&row);
    }
    std::sort(sorted.begin(), sorted.end(), [](const LatencyRow* a, const LatencyRow* b) {
      return a->options.mesh.node_count() < b->options.mesh.node_count();
    });
    const auto add = [](common::Curve& curve, int nodes, const Samples& samples, double q) {
      if (samples.count() == 0) return;
      curve.x.push_back(nodes);
      curve.y.push_back(1e3 * samples.quantile(q));
    };
    for (const LatencyRow* row : sorted) {
      const int nodes = row->options.mesh.node_count();
      add(p50, nodes, row->result.step.wall, 0.5);
      add(p99, nodes, row->result.step.wall, 0.99);
      add(cholmod, nodes, row->result.cholmod.times.wall, 0.5);
      add(pcg, nodes, row->result.pcg.times.wall, 0.5);
    }
    for (const auto* curve : {&p50, &p99, &cholmod, &pcg}) {
      if (!curve->x.empty()) plot.curves.push_back(*curve);
    }
  }
  common::try_draw({plot}, png);
}

}  // namespace palpate::bench
