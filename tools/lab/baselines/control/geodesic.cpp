#include "tools/lab/baselines/control/geodesic.hpp"

#include <limits>
#include <queue>
#include <utility>

namespace palpate::baselines {

std::vector<double> geodesic_distances(const mesh::ElementMesh& mesh,
                                       const std::vector<int>& sources) {
  std::vector<std::vector<int>> elements_of(mesh.node_count());
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int a = 0; a < mesh.nodes_per_element(); ++a)
      elements_of[mesh.elements(a, e)].push_back(e);

  std::vector<double> distance(mesh.node_count(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (const int node : sources) {
    distance[node] = 0;
    open.emplace(0.0, node);
  }
  while (!open.empty()) {
    const auto [far, node] = open.top();
    open.pop();
    if (far > distance[node]) continue;
    for (const int e : elements_of[node]) {
      for (int a = 0; a < mesh.nodes_per_element(); ++a) {
        const int other = mesh.elements(a, e);
        const double further = far + (mesh.nodes.col(other) - mesh.nodes.col(node)).norm();
        if (further >= distance[other]) continue;
        distance[other] = further;
        open.emplace(further, other);
      }
    }
  }
  return distance;
}

}  // namespace palpate::baselines
