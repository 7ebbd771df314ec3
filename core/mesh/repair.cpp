#include "core/mesh/repair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/mesh/connectivity.hpp"
#include "core/mesh/mesh_writer.hpp"
#include "core/mesh/near_nodes.hpp"
#include "core/mesh/node_motion.hpp"
#include "core/mesh/report.hpp"

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

class Repair {
 public:
  Repair(MeshWithGroups& mesh, const RepairOptions& options) : mesh_(mesh), options_(options) {
    if (mesh.node_numbers.empty()) mesh.number_from(0);
  }

  std::vector<RepairStep> run() {
    split_others();
    std::vector<long> stray = unused();
    // before nodes are merged: an unused node at the position of another is no reason for a merge
    if (!stray.empty()) drop(mesh_, std::vector<bool>(mesh_.mesh.tetrahedron_count(), false));
    merge_nodes();
    drop_degenerate_and_repeated();
    // the following steps require finite numbers
    const MeshReport before = check(mesh_.mesh);
    if (before.not_finite.empty() && before.index_out_of_range.empty()) {
      turn();
      remove_flat();
      drop_parts();
    }
    add("nodes dropped that are in no element", std::move(stray));
    return std::move(steps_);
  }

 private:
  void add(const std::string& what, std::vector<long> numbers) {
    if (!numbers.empty()) steps_.push_back({what, std::move(numbers)});
  }
  std::vector<long> numbers(const std::vector<int>& tetrahedra) const {
    std::vector<long> result;
    for (const int t : tetrahedra) result.push_back(mesh_.tetrahedron_number(t));
    return result;
  }

  void split_others() {
    std::vector<long> cells;
    for (const OtherCell& cell : mesh_.others) {
      const auto end = cell.corners.begin() + cell.corner_count;
      if (std::all_of(cell.corners.begin(), end, [](int n) { return n >= 0; }))
        cells.push_back(cell.number);
    }
    split_cells(mesh_);
    add("pyramids, prisms and hexahedra cut into tetrahedra", std::move(cells));
  }

  void merge_nodes() {
    const double tolerance = options_.merge_tolerance * diagonal(mesh_.mesh.nodes);
    const std::vector<int> by = near_nodes(mesh_.mesh.nodes, tolerance);
    std::vector<long> merged;
    for (int n = 0; n < mesh_.mesh.node_count(); ++n) {
      if (by[n] != n) merged.push_back(mesh_.node_number(n));
    }
    if (merged.empty()) return;
    replace_nodes(mesh_, by);
    drop(mesh_, std::vector<bool>(mesh_.mesh.tetrahedron_count(), false));
    add("nodes merged into others within " + shortest(tolerance) + " m", std::move(merged));
    merged_ = true;
  }

  void drop_degenerate_and_repeated() {
    const TetrahedralMesh& m = mesh_.mesh;
    std::vector<bool> gone(m.tetrahedron_count(), false);
    std::vector<int> degenerate, repeated;
    std::map<std::array<int, 4>, int> known;
    for (int t = 0; t < m.tetrahedron_count(); ++t) {
      const std::array<int, 4> c = sorted_corners(m, t);
      if (c[0] < 0) continue;  // a missing corner is not handled here
      if (std::adjacent_find(c.begin(), c.end()) != c.end()) {
        degenerate.push_back(t);
        continue;
      }
      const auto [found, is_new] = known.try_emplace(c, t);
      if (is_new) continue;
      repeated.push_back(t);
      for (auto& [name, group] : mesh_.groups) {  // the remaining one belongs to the groups of both
        auto& members = group.tetrahedra;
        if (!std::binary_search(members.begin(), members.end(), t)) continue;
        const auto at = std::lower_bound(members.begin(), members.end(), found->second);
        if (at == members.end() || *at != found->second) members.insert(at, found->second);
      }
    }
    for (const int t : degenerate) gone[t] = true;
    for (const int t : repeated) gone[t] = true;
    add(merged_ ? "elements dropped that name a node twice or lost a corner by merging"
                : "elements dropped that name a node twice",
        numbers(degenerate));
    add("elements dropped that are there twice", numbers(repeated));
    if (!degenerate.empty() || !repeated.empty()) drop(mesh_, gone);
  }

  std::vector<int> negative() const { return check(mesh_.mesh).negative_volume; }

  /// Files differ in orientation: if most elements are inverted, all are reversed.
  void turn() {
    std::vector<int> wrong = negative();
    if (wrong.empty()) return;
    if (2 * static_cast<int>(wrong.size()) > mesh_.mesh.tetrahedron_count()) {
      for (int t = 0; t < mesh_.mesh.tetrahedron_count(); ++t) exchange(t);
      const std::vector<int> others = negative();
      std::vector<int> turned;
      std::set_difference(wrong.begin(), wrong.end(), others.begin(), others.end(),
                          std::back_inserter(turned));
      add("elements turned: their order of corners was the mirror image", numbers(turned));
      wrong = others;
    }
    recover_inverted_elements(wrong);
    const std::vector<int> left = negative();
    for (const int t : left) exchange(t);
    add("elements turned: their order of corners was the mirror image", numbers(left));
  }

  void exchange(int t) { std::swap(mesh_.mesh.tetrahedra(2, t), mesh_.mesh.tetrahedra(3, t)); }

  /// An element whose neighbours lie on the other sides of its faces merely has reversed
  /// orientation; one that overlaps a neighbour was inverted by a misplaced node.
  void recover_inverted_elements(const std::vector<int>& wrong) {
    const std::vector<int> overlapping = check(mesh_.mesh).overlapping;
    std::vector<int> tangled;
    std::set_intersection(wrong.begin(), wrong.end(), overlapping.begin(), overlapping.end(),
                          std::back_inserter(tangled));
    if (tangled.empty()) return;
    std::set<int> nodes;
    for (const int t : tangled) {
      for (const int n : mesh_.mesh.tetrahedra.col(t)) nodes.insert(n);
    }
    const MeshWithGroups kept = mesh_;
    NodeMotionOptions options;
    options.only.assign(nodes.begin(), nodes.end());
    move_nodes(mesh_, options);
    std::vector<long> righted;
    for (const int t : tangled) {
      if (volume(mesh_.mesh, t) > 0) righted.push_back(mesh_.tetrahedron_number(t));
    }
    if (righted.size() < tangled.size()) {
      mesh_ = kept;  // without success: report the original state
    } else {
      add("elements that a strayed node had turned inside out, righted by moving nodes inside",
          std::move(righted));
    }
  }

  void remove_flat() {
    FlatElements done = remove_flat_elements(mesh_);
    add("elements without volume peeled off the surface", std::move(done.peeled));
    add("elements without volume given some by moving nodes", std::move(done.inflated));
    add("elements without volume removed by collapsing an edge", std::move(done.collapsed));
  }

  void drop_parts() {
    if (options_.parts != Parts::kKeepLargest) return;
    const std::vector<int> parts = parts_by_faces(mesh_.mesh);
    std::vector<bool> gone;
    for (const int part : parts) gone.push_back(part > 0);
    const std::vector<int> small = indices_of(gone);
    add("elements dropped that are not of the largest part", numbers(small));
    if (!small.empty()) drop(mesh_, gone);
  }

  std::vector<long> unused() const {
    std::vector<long> result;
    const auto used = used_nodes(mesh_.mesh.tetrahedra, mesh_.mesh.node_count());
    for (const int n : indices_of(used, false)) result.push_back(mesh_.node_number(n));
    return result;
  }

  MeshWithGroups& mesh_;
  const RepairOptions& options_;
  std::vector<RepairStep> steps_;
  bool merged_ = false;
};

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

std::vector<RepairStep> repair(MeshWithGroups& mesh, const RepairOptions& options) {
  return Repair(mesh, options).run();
}

}  // namespace palpate::mesh
