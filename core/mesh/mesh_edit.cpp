#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>

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
  std::vector<int> element(m.tetrahedron_count(), -1), node(m.node_count(), -1);
  int elements = 0, nodes = 0;
  for (int t = 0; t < m.tetrahedron_count(); ++t) {
    if (tetrahedra[t]) continue;
    for (const int n : m.tetrahedra.col(t)) {
      if (n >= 0) node[n] = 0;
    }
    m.tetrahedra.col(elements) = m.tetrahedra.col(t);
    if (!mesh.tetrahedron_numbers.empty())
      mesh.tetrahedron_numbers[elements] = mesh.tetrahedron_numbers[t];
    element[t] = elements++;
  }
  for (OtherCell& cell : mesh.others) {
    for (int i = 0; i < cell.corner_count; ++i) {
      if (cell.corners[i] >= 0) node[cell.corners[i]] = 0;
    }
  }
  for (int n = 0; n < m.node_count(); ++n) {
    if (node[n] < 0) continue;
    m.nodes.col(nodes) = m.nodes.col(n);
    if (!mesh.node_numbers.empty()) mesh.node_numbers[nodes] = mesh.node_numbers[n];
    node[n] = nodes++;
  }
  m.tetrahedra.conservativeResize(4, elements);
  m.nodes.conservativeResize(3, nodes);
  if (!mesh.tetrahedron_numbers.empty()) mesh.tetrahedron_numbers.resize(elements);
  if (!mesh.node_numbers.empty()) mesh.node_numbers.resize(nodes);
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
  std::vector<int> parent(count);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&parent](int t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  std::map<std::array<int, 3>, int> faces;
  for (int t = 0; t < count; ++t) {
    for (int left_out = 0; left_out < 4; ++left_out) {
      std::array<int, 3> face{};
      for (int i = 0, k = 0; i < 4; ++i) {
        if (i != left_out) face[k++] = mesh.tetrahedra(i, t);
      }
      std::sort(face.begin(), face.end());
      const auto [found, is_new] = faces.try_emplace(face, t);
      if (!is_new) parent[root(t)] = root(found->second);
    }
  }
  std::map<int, double> volumes;
  for (int t = 0; t < count; ++t) volumes[root(t)] += std::abs(volume(mesh, t));
  std::vector<int> order;
  for (const auto& [part, v] : volumes) order.push_back(part);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return volumes[a] > volumes[b]; });
  std::map<int, int> rank;
  for (const int part : order) rank.emplace(part, static_cast<int>(rank.size()));
  std::vector<int> parts(count);
  for (int t = 0; t < count; ++t) parts[t] = rank[root(t)];
  return parts;
}

}  // namespace palpate::mesh
