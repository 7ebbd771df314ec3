#include <algorithm>
#include <map>
#include <set>

#include "core/mesh/connectivity.hpp"
#include "core/mesh/repair.hpp"

namespace palpate::mesh {
namespace {

void rebuild_nodes(const TetrahedralMesh& mesh, MeshGroup& group) {
  std::set<int> nodes(group.triangles.reshaped().begin(), group.triangles.reshaped().end());
  for (const int t : group.tetrahedra) {
    for (const int n : mesh.tetrahedra.col(t)) {
      if (n >= 0) nodes.insert(n);
    }
  }
  group.nodes.assign(nodes.begin(), nodes.end());
}

/// Triangles with new node numbers; those with a removed (-1) or repeated corner are dropped.
Eigen::Matrix3Xi renumbered(const Eigen::Matrix3Xi& triangles, const std::vector<int>& number) {
  Eigen::Matrix3Xi result(3, triangles.cols());
  int count = 0;
  for (int t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3i c = triangles.col(t).unaryExpr([&](int n) { return number[n]; });
    if (c.minCoeff() < 0 || c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    result.col(count++) = c;
  }
  result.conservativeResize(3, count);
  return result;
}

EdgeMiddles renumbered(const EdgeMiddles& middles, const std::vector<int>& number) {
  EdgeMiddles result;
  for (const auto& [edge, middle] : middles) {
    const int a = number[edge.first], b = number[edge.second];
    if (a >= 0 && b >= 0 && a != b) result.emplace(std::minmax(a, b), middle);
  }
  return result;
}

void renumber(std::vector<OtherCell>& cells, const std::vector<int>& number) {
  for (OtherCell& cell : cells) {
    for (int i = 0; i < cell.corner_count; ++i) {
      if (cell.corners[i] >= 0) cell.corners[i] = number[cell.corners[i]];
    }
  }
}

/// Keeps these entries of a list, if there is one.
void select(std::vector<long>& numbers, const std::vector<int>& kept) {
  if (numbers.empty()) return;
  std::vector<long> left;
  for (const int i : kept) left.push_back(numbers[i]);
  numbers = std::move(left);
}

}  // namespace

void replace_nodes(MeshWithGroups& mesh, const std::vector<int>& by) {
  for (int& n : mesh.mesh.tetrahedra.reshaped()) {
    if (n >= 0) n = by[n];
  }
  renumber(mesh.others, by);
  for (auto& [name, group] : mesh.groups) {
    group.triangles = renumbered(group.triangles, by);
    rebuild_nodes(mesh.mesh, group);
  }
  mesh.middles = renumbered(mesh.middles, by);
}

void drop(MeshWithGroups& mesh, const std::vector<bool>& tetrahedra) {
  TetrahedralMesh& m = mesh.mesh;
  const std::vector<int> kept = indices_of(tetrahedra, false);
  m.tetrahedra = m.tetrahedra(Eigen::all, kept).eval();
  select(mesh.tetrahedron_numbers, kept);
  std::vector<bool> used = used_nodes(m.tetrahedra, m.node_count());
  for (const OtherCell& cell : mesh.others) {
    for (int i = 0; i < cell.corner_count; ++i) {
      if (cell.corners[i] >= 0) used[cell.corners[i]] = true;
    }
  }
  const std::vector<int> nodes = indices_of(used);
  m.nodes = m.nodes(Eigen::all, nodes).eval();
  select(mesh.node_numbers, nodes);
  const std::vector<int> node = new_numbers(used);
  std::vector<int> element(tetrahedra.size(), -1);
  for (std::size_t k = 0; k < kept.size(); ++k) element[kept[k]] = static_cast<int>(k);
  for (int& n : m.tetrahedra.reshaped()) {
    if (n >= 0) n = node[n];
  }
  renumber(mesh.others, node);
  for (auto group = mesh.groups.begin(); group != mesh.groups.end();) {
    MeshGroup& g = group->second;
    std::vector<int> left;
    for (const int t : g.tetrahedra) {
      if (element[t] >= 0) left.push_back(element[t]);
    }
    g.tetrahedra = std::move(left);
    g.triangles = renumbered(g.triangles, node);
    rebuild_nodes(m, g);
    group = g.nodes.empty() ? mesh.groups.erase(group) : std::next(group);
  }
  mesh.middles = renumbered(mesh.middles, node);
}

std::vector<int> parts_by_faces(const TetrahedralMesh& mesh) {
  const int count = mesh.tetrahedron_count();
  DisjointSets sets(count);
  for (const auto& [face, at] : tetrahedra_by_face(mesh)) {
    for (const int t : at) sets.join(t, at.front());
  }
  std::map<int, double> volumes;
  for (int t = 0; t < count; ++t) volumes[sets.root(t)] += std::abs(volume(mesh, t));
  std::vector<int> order;
  for (const auto& [part, v] : volumes) order.push_back(part);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return volumes[a] > volumes[b]; });
  std::map<int, int> rank;
  for (const int part : order) rank.emplace(part, static_cast<int>(rank.size()));
  std::vector<int> parts(count);
  for (int t = 0; t < count; ++t) parts[t] = rank[sets.root(t)];
  return parts;
}

}  // namespace palpate::mesh
