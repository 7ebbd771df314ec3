#include "core/mesh/grid_mesh.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

namespace palpate::mesh {
namespace {

using Cell = std::array<int, 3>;

/// Corner `c` of a cell: bit k is set if it lies on the far side along axis k.
Cell corner(const Cell& cell, int c) {
  return {cell[0] + (c & 1), cell[1] + ((c >> 1) & 1), cell[2] + ((c >> 2) & 1)};
}

using Tetrahedra = std::vector<std::array<int, 4>>;  // corners of one cell

/// One tetrahedron per order in which a path from corner 000 to 111 follows the axes; odd orders
/// have two corners exchanged for positive orientation.
Tetrahedra six() {
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  Tetrahedra all;
  for (int order = 0; order < 6; ++order) {
    std::array<int, 4> path{};
    for (int s = 0; s < 3; ++s) path[s + 1] = path[s] | (1 << kOrders[order][s]);
    if (order >= 3) std::swap(path[1], path[2]);
    all.push_back(path);
  }
  return all;
}

/// The corners with an even number of far sides form the inner tetrahedron; each other corner forms
/// one more. Mirrored along x in every second cell.
Tetrahedra five(bool mirrored) {
  Tetrahedra all = {{0, 3, 6, 5}, {1, 3, 0, 5}, {2, 0, 3, 6}, {4, 0, 6, 5}, {7, 3, 5, 6}};
  if (!mirrored) return all;
  for (auto& tetrahedron : all) {
    for (int& c : tetrahedron) c ^= 1;
    std::swap(tetrahedron[2], tetrahedron[3]);
  }
  return all;
}

}  // namespace

GridPlanes even_planes(const Eigen::Vector3d& lower, const Eigen::Vector3d& size,
                       const std::array<int, 3>& cells) {
  GridPlanes planes;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i <= cells[axis]; ++i)
      planes[axis].push_back(lower[axis] + size[axis] * i / cells[axis]);
  }
  return planes;
}

void align(const std::vector<double>& through, std::vector<double>& planes) {
  const std::ptrdiff_t last = static_cast<std::ptrdiff_t>(planes.size()) - 1;
  std::set<double> wanted;
  for (const double coordinate : through)
    if (planes.front() < coordinate && coordinate < planes.back()) wanted.insert(coordinate);
  while (static_cast<std::ptrdiff_t>(wanted.size()) > last - 1)
    wanted.erase(std::prev(wanted.end()));
  std::map<std::ptrdiff_t, double> kept{{0, planes.front()}, {last, planes.back()}};
  std::ptrdiff_t before = 0, to_come = static_cast<std::ptrdiff_t>(wanted.size());
  for (const double coordinate : wanted) {
    const auto above = std::lower_bound(planes.begin(), planes.end(), coordinate);
    const bool is_above = *above - coordinate < coordinate - *std::prev(above);
    const std::ptrdiff_t nearest = above - planes.begin() - (is_above ? 0 : 1);
    before = std::clamp(nearest, before + 1, last - to_come--);
    kept[before] = coordinate;
  }
  for (auto end = std::next(kept.begin()); end != kept.end(); ++end) {
    const auto [first, lower] = *std::prev(end);
    const double step = (end->second - lower) / static_cast<double>(end->first - first);
    for (std::ptrdiff_t i = first; i < end->first; ++i)
      planes[static_cast<std::size_t>(i)] = lower + static_cast<double>(i - first) * step;
  }
}

TetrahedralMesh make_grid(const GridPlanes& planes, CellCut cut,
                          const std::function<bool(const Eigen::Vector3d&)>& keep) {
  Cell cells{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& p = planes[axis];
    if (p.size() < 2 || std::adjacent_find(p.begin(), p.end(), std::greater_equal<>()) != p.end()) {
      throw std::invalid_argument("a grid needs at least two rising planes along each axis");
    }
    cells[axis] = static_cast<int>(p.size()) - 1;
  }
  const auto index = [&cells](const Cell& at) {
    return at[0] + (cells[0] + 1) * (at[1] + (cells[1] + 1) * at[2]);
  };
  const auto position = [&planes](const Cell& at) {
    return Eigen::Vector3d(planes[0][at[0]], planes[1][at[1]], planes[2][at[2]]);
  };

  const std::array<Tetrahedra, 2> cuts = cut == CellCut::kSix
                                             ? std::array<Tetrahedra, 2>{six(), six()}
                                             : std::array<Tetrahedra, 2>{five(false), five(true)};
  std::vector<Eigen::Vector4i> tetrahedra;
  std::vector<int> number(index(cells) + 1, -1);  // number of each grid point; -1: not used
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        const Cell cell{i, j, k};
        if (keep && !keep(0.5 * (position(cell) + position(corner(cell, 7))))) continue;
        for (const auto& corners : cuts[(i + j + k) % 2]) {
          Eigen::Vector4i& t = tetrahedra.emplace_back();
          for (int c = 0; c < 4; ++c) {
            t[c] = index(corner(cell, corners[c]));
            number[t[c]] = 0;
          }
        }
      }
    }
  }
  if (tetrahedra.empty()) throw std::invalid_argument("no cell of the grid is kept");

  TetrahedralMesh mesh;
  mesh.nodes.resize(3, std::count(number.begin(), number.end(), 0));
  int next = 0;
  for (int k = 0; k <= cells[2]; ++k) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int i = 0; i <= cells[0]; ++i) {
        int& n = number[index({i, j, k})];
        if (n < 0) continue;
        mesh.nodes.col(next) = position({i, j, k});
        n = next++;
      }
    }
  }
  mesh.tetrahedra.resize(4, static_cast<int>(tetrahedra.size()));
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    mesh.tetrahedra.col(t) = tetrahedra[t].unaryExpr([&number](int n) { return number[n]; });
  }
  return mesh;
}

}  // namespace palpate::mesh
