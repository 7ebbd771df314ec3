#include "core/mesh/tetrahedral_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/math/fnv1a.hpp"

namespace palpate::mesh {
std::int64_t hash(const TetrahedralMesh& mesh) {
  math::Fnv1a fnv;
  const std::int64_t counts[2] = {mesh.node_count(), mesh.tetrahedron_count()};
  fnv.add(counts, sizeof counts);
  fnv.add(mesh.nodes.data(), sizeof(double) * mesh.nodes.size());
  fnv.add(mesh.tetrahedra.data(), sizeof(int) * mesh.tetrahedra.size());
  return fnv.signed_value();
}

double volume(const TetrahedralMesh& mesh, int t) {
  const Eigen::Vector3d p0 = mesh.nodes.col(mesh.tetrahedra(0, t));
  const Eigen::Vector3d a = mesh.nodes.col(mesh.tetrahedra(1, t)) - p0;
  const Eigen::Vector3d b = mesh.nodes.col(mesh.tetrahedra(2, t)) - p0;
  const Eigen::Vector3d c = mesh.nodes.col(mesh.tetrahedra(3, t)) - p0;
  return a.dot(b.cross(c)) / 6;
}

int orient(TetrahedralMesh& mesh) {
  int flipped = 0;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    if (volume(mesh, t) >= 0) continue;
    std::swap(mesh.tetrahedra(2, t), mesh.tetrahedra(3, t));
    ++flipped;
  }
  return flipped;
}

TetrahedralMesh make_box(const Eigen::Vector3d& size, const std::array<int, 3>& cells) {
  if (!(size.array() > 0).all() || *std::min_element(cells.begin(), cells.end()) < 1) {
    throw std::invalid_argument("a box needs positive size and at least one cell per axis");
  }
  const auto index = [&cells](int i, int j, int k) {
    return i + (cells[0] + 1) * (j + (cells[1] + 1) * k);
  };
  TetrahedralMesh mesh;
  mesh.nodes.resize(3, (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1));
  for (int k = 0; k <= cells[2]; ++k) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int i = 0; i <= cells[0]; ++i) {
        mesh.nodes.col(index(i, j, k)) << size[0] * i / cells[0], size[1] * j / cells[1],
            size[2] * k / cells[2];
      }
    }
  }
  // Kuhn: one tetrahedron for each order in which a path from corner 000 to 111 takes the axes; odd
  // orders have two corners exchanged to stay positively oriented.
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  mesh.tetrahedra.resize(4, 6 * cells[0] * cells[1] * cells[2]);
  int t = 0;
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        for (int order = 0; order < 6; ++order) {
          int step[3] = {i, j, k};
          Eigen::Vector4i corners;
          corners[0] = index(i, j, k);
          for (int s = 0; s < 3; ++s) {
            ++step[kOrders[order][s]];
            corners[s + 1] = index(step[0], step[1], step[2]);
          }
          if (order >= 3) std::swap(corners[1], corners[2]);
          mesh.tetrahedra.col(t++) = corners;
        }
      }
    }
  }
  return mesh;
}

}  // namespace palpate::mesh
