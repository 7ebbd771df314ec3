#include "core/mesh/cell_split.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace palpate::mesh {
namespace {

using Tetrahedron = std::array<int, 4>;
using Quadrilateral = std::array<int, 4>;

/// Two triangles of a rectangle, divided at its corner with the lowest number.
std::array<std::array<int, 3>, 2> cut(const Quadrilateral& q) {
  const int low = static_cast<int>(std::min_element(q.begin(), q.end()) - q.begin());
  const auto at = [&](int i) { return q[(low + i) % 4]; };
  return {{{at(0), at(1), at(2)}, {at(0), at(2), at(3)}}};
}

void add_pyramid(const Quadrilateral& base, int tip, std::vector<Tetrahedron>& all) {
  for (const auto& [a, b, c] : cut(base)) all.push_back({a, b, c, tip});
}

/// With respect to its corner with the lowest number, a prism consists of a tetrahedron over the
/// opposite triangle and a pyramid over the opposite rectangle.
void add_prism(const std::array<int, 8>& c, std::vector<Tetrahedron>& all) {
  const int low = static_cast<int>(std::min_element(c.begin(), c.begin() + 6) - c.begin());
  const int side = low / 3, turn = low % 3;
  const auto near = [&](int i) { return c[3 * side + (turn + i) % 3]; };
  const auto far = [&](int i) { return c[3 * (1 - side) + (turn + i) % 3]; };
  all.push_back({near(0), far(0), far(1), far(2)});
  add_pyramid({near(1), near(2), far(2), far(1)}, near(0), all);
}

void add_hexahedron(const std::array<int, 8>& c, int middle, std::vector<Tetrahedron>& all) {
  constexpr int kFaces[6][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  for (const auto& f : kFaces) add_pyramid({c[f[0]], c[f[1]], c[f[2]], c[f[3]]}, middle, all);
}

}  // namespace

int split_cells(MeshWithGroups& mesh) {
  TetrahedralMesh& m = mesh.mesh;
  int n = m.node_count(), t = m.tetrahedron_count();
  const auto cells = static_cast<int>(mesh.others.size());
  if (cells == 0) return 0;
  constexpr int kMostParts = 12;
  m.nodes.conservativeResize(3, n + cells);
  m.tetrahedra.conservativeResize(4, t + kMostParts * cells);
  std::vector<OtherCell> left;
  for (const OtherCell& cell : mesh.others) {
    const auto end = cell.corners.begin() + cell.corner_count;
    if (std::any_of(cell.corners.begin(), end, [](int corner) { return corner < 0; })) {
      left.push_back(cell);
      continue;
    }
    std::vector<Tetrahedron> parts;
    if (cell.corner_count == 5) {
      add_pyramid({cell.corners[0], cell.corners[1], cell.corners[2], cell.corners[3]},
                  cell.corners[4], parts);
    } else if (cell.corner_count == 6) {
      add_prism(cell.corners, parts);
    } else {
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      for (const int corner : cell.corners) middle += m.nodes.col(corner) / 8;
      m.nodes.col(n) = middle;
      mesh.node_numbers.push_back(-1);
      add_hexahedron(cell.corners, n++, parts);
    }
    for (const Tetrahedron& part : parts) {
      m.tetrahedra.col(t) << part[0], part[1], part[2], part[3];
      // the order of corners of the parts may differ in orientation
      if (volume(m, t) < 0) std::swap(m.tetrahedra(2, t), m.tetrahedra(3, t));
      mesh.tetrahedron_numbers.push_back(cell.number);
      ++t;
    }
  }
  m.nodes.conservativeResize(3, n);
  m.tetrahedra.conservativeResize(4, t);
  const int done = cells - static_cast<int>(left.size());
  mesh.others = std::move(left);
  return done;
}

}  // namespace palpate::mesh
