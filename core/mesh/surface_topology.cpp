#include "core/mesh/surface_topology.hpp"

#include <algorithm>
#include <set>

namespace palpate::mesh {

SurfaceTopology::SurfaceTopology(const TriangleSurface& surface) : surface_(surface) {
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const Eigen::Vector3i c = surface.triangles.col(t);
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    for (int i = 0; i < 3; ++i) edges_[std::minmax(c[i], c[(i + 1) % 3])].push_back(t);
  }
}

bool SurfaceTopology::runs_along(int t, int from, int to) const {
  for (int i = 0; i < 3; ++i) {
    if (surface_.triangles(i, t) == from && surface_.triangles((i + 1) % 3, t) == to) return true;
  }
  return false;
}

std::vector<std::vector<int>> SurfaceTopology::holes() const {
  std::map<int, std::vector<int>> next;  // successors of a point on the rim
  for (const auto& [edge, at] : edges_) {
    if (at.size() != 1) continue;
    // against the direction of the existing triangle
    const bool forth = runs_along(at[0], edge.first, edge.second);
    next[forth ? edge.second : edge.first].push_back(forth ? edge.first : edge.second);
  }
  std::vector<std::vector<int>> loops;
  for (auto& [start, ends] : next) {
    while (!ends.empty()) {
      std::vector<int> loop{start};
      for (int at = start;;) {
        auto& out = next[at];
        if (out.empty()) break;  // neighbours with opposite orientation: no loop
        at = out.back();
        out.pop_back();
        if (at == start) break;
        // where rims touch, a completed section is a loop of its own
        const auto again = std::find(loop.begin(), loop.end(), at);
        if (again != loop.end()) {
          loops.emplace_back(again, loop.end());
          loop.erase(again + 1, loop.end());
        } else {
          loop.push_back(at);
        }
      }
      loops.push_back(std::move(loop));
    }
  }
  return loops;
}

std::vector<Edge> SurfaceTopology::crowded_edges() const {
  std::vector<Edge> crowded;
  for (const auto& [edge, at] : edges_) {
    if (at.size() > 2) crowded.push_back(edge);
  }
  return crowded;
}

SurfaceSides SurfaceTopology::sides() const {
  const int count = surface_.triangle_count();
  // neighbours of each triangle, and whether they have the same orientation
  std::vector<std::vector<std::pair<int, bool>>> neighbours(count);
  for (const auto& [edge, at] : edges_) {
    for (std::size_t i = 1; i < at.size(); ++i) {
      const bool alike =
          runs_along(at[0], edge.first, edge.second) != runs_along(at[i], edge.first, edge.second);
      // at an edge of more than two triangles orientation is undefined, but the triangles are
      // connected
      if (at.size() > 2) continue;
      neighbours[at[0]].emplace_back(at[i], alike);
      neighbours[at[i]].emplace_back(at[0], alike);
    }
  }
  SurfaceSides sides;
  sides.part.assign(count, -1);
  sides.turned.assign(count, false);
  std::set<int> one_sided;
  int parts = 0;
  for (int start = 0; start < count; ++start) {
    if (sides.part[start] >= 0) continue;
    std::vector<int> members{start};
    sides.part[start] = parts;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const int t = members[i];
      for (const auto& [other, alike] : neighbours[t]) {
        const bool turned = alike == static_cast<bool>(sides.turned[t]);
        if (sides.part[other] < 0) {
          sides.part[other] = parts;
          sides.turned[other] = turned;
          members.push_back(other);
        } else if (sides.turned[other] != turned) {
          one_sided.insert(parts);
        }
      }
    }
    const auto wrong =
        std::count_if(members.begin(), members.end(), [&](int t) { return sides.turned[t]; });
    if (2 * wrong > static_cast<long>(members.size())) {
      for (const int t : members) sides.turned[t] = !sides.turned[t];
    }
    ++parts;
  }
  sides.one_sided.assign(one_sided.begin(), one_sided.end());
  return sides;
}

}  // namespace palpate::mesh
