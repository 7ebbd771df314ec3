#include "core/mesh/connectivity.hpp"

#include <algorithm>
#include <numeric>

namespace palpate::mesh {

DisjointSets::DisjointSets(int count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

int DisjointSets::root(int item) {
  while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
  return item;
}

Face face_of(const TetrahedralMesh& mesh, int t, int left_out) {
  Face face{};
  for (int i = 0, k = 0; i < 4; ++i) {
    if (i != left_out) face[k++] = mesh.tetrahedra(i, t);
  }
  std::sort(face.begin(), face.end());
  return face;
}

std::map<Face, std::vector<int>> tetrahedra_by_face(const TetrahedralMesh& mesh) {
  std::map<Face, std::vector<int>> faces;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    for (int i = 0; i < 4; ++i) faces[face_of(mesh, t, i)].push_back(t);
  }
  return faces;
}

std::array<int, 4> sorted_corners(const TetrahedralMesh& mesh, int t) {
  std::array<int, 4> corners{};
  std::copy_n(mesh.tetrahedra.col(t).begin(), 4, corners.begin());
  std::sort(corners.begin(), corners.end());
  return corners;
}

Surface extract_surface(const TetrahedralMesh& mesh) {
  return extract_surface(make_element_mesh(mesh, ElementOrder::kLinear));
}

std::map<Edge, std::vector<int>> triangles_by_edge(const Eigen::Matrix3Xi& triangles) {
  std::map<Edge, std::vector<int>> edges;
  for (int t = 0; t < triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i)
      edges[std::minmax({triangles(i, t), triangles((i + 1) % 3, t)})].push_back(t);
  }
  return edges;
}

std::vector<int> pinched_nodes(const Eigen::Matrix3Xi& triangles) {
  std::map<int, std::vector<Edge>> opposite;  // sides of the triangles around each node
  for (int t = 0; t < triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i)
      opposite[triangles(i, t)].push_back({triangles((i + 1) % 3, t), triangles((i + 2) % 3, t)});
  }
  std::vector<int> pinched;
  for (const auto& [node, sides] : opposite) {
    std::map<int, int> parent;  // of the neighbours of a fan; one of them is its own
    const auto root = [&parent](int n) {
      while (parent[n] != n) n = parent[n];
      return n;
    };
    for (const auto& [a, b] : sides) {
      parent.emplace(a, a);
      parent.emplace(b, b);
      parent[root(a)] = root(b);
    }
    const auto fans = std::count_if(parent.begin(), parent.end(),
                                    [](const auto& p) { return p.first == p.second; });
    if (fans > 1) pinched.push_back(node);
  }
  return pinched;
}

std::vector<int> out_of_range(const Eigen::Ref<const Eigen::MatrixXi>& elements, int count) {
  std::vector<int> wrong;
  for (int e = 0; e < elements.cols(); ++e) {
    if (elements.col(e).minCoeff() < 0 || elements.col(e).maxCoeff() >= count) wrong.push_back(e);
  }
  return wrong;
}

std::vector<int> not_finite(const Eigen::Matrix3Xd& points) {
  std::vector<int> wrong;
  for (int n = 0; n < points.cols(); ++n) {
    if (!points.col(n).allFinite()) wrong.push_back(n);
  }
  return wrong;
}

std::vector<bool> used_nodes(const Eigen::Ref<const Eigen::MatrixXi>& elements, int count) {
  std::vector<bool> used(count, false);
  for (int e = 0; e < elements.cols(); ++e) {
    for (const int n : elements.col(e)) {
      if (n >= 0) used[n] = true;
    }
  }
  return used;
}

std::vector<int> indices_of(const std::vector<bool>& flags, bool wanted) {
  std::vector<int> indices;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (flags[i] == wanted) indices.push_back(static_cast<int>(i));
  }
  return indices;
}

std::vector<int> new_numbers(const std::vector<bool>& keep) {
  std::vector<int> numbers(keep.size(), -1);
  int next = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i]) numbers[i] = next++;
  }
  return numbers;
}

}  // namespace palpate::mesh
