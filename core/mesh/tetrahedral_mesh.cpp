#include "core/mesh/tetrahedral_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/math/fnv1a.hpp"
#include "core/mesh/grid_mesh.hpp"

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
  return make_grid(even_planes(Eigen::Vector3d::Zero(), size, cells), CellCut::kSix);
}

}  // namespace palpate::mesh
