#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <sstream>

#include "core/mesh/near_nodes.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/surface.hpp"
#include "tools/mesh/faults.hpp"

namespace palpate::mesh_tool {
namespace {

constexpr double kSliver = 0.02;  // radius ratio
constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

class VolumeFaults {
 public:
  explicit VolumeFaults(const mesh::MeshWithGroups& mesh)
      : mesh_(mesh), report_(mesh::check(mesh.mesh)) {}

  std::vector<Fault> find() {
    if (mesh_.mesh.tetrahedron_count() == 0 && mesh_.others.empty()) {
      Fault fault;
      fault.kind = "empty";
      fault.text = "there are no tetrahedra";
      faults_.push_back(fault);
    }
    add_others();
    add_elements("out_of_range", "tetrahedra that name a node which is not there",
                 report_.index_out_of_range);
    add_nodes("not_finite", "nodes with a coordinate that is not finite", report_.not_finite);
    show_neighbours_of_bad_nodes();
    if (report_.index_out_of_range.empty() && report_.not_finite.empty()) add_geometry();
    add_size_fault(mesh_.mesh.nodes, faults_);
    return std::move(faults_);
  }

 private:
  void add_geometry() {
    add_elements("inverted", "tetrahedra turned inside out", report_.negative_volume);
    add_elements("flat", "tetrahedra without volume", report_.zero_volume);
    add_repeated();
    add_elements("overlap", "tetrahedra that overlap a neighbour", overlapping_);
    add_nodes("duplicate_node", "nodes that lie on another", report_.duplicate_nodes);
    add_nodes("unused_node", "nodes in no tetrahedron", report_.unused_nodes);
    add_parts();
    add_hinges();
    std::vector<int> slivers;
    const std::set<int> flat(report_.zero_volume.begin(), report_.zero_volume.end());
    for (int t = 0; t < mesh_.mesh.tetrahedron_count(); ++t) {
      if (flat.count(t) == 0 && mesh::radius_ratio(mesh_.mesh, t) < kSliver) slivers.push_back(t);
    }
    add_elements("sliver", "slivers: tetrahedra with a radius ratio below 0.02", slivers,
                 Severity::kWarning);
  }

  void show(int t, Fault& fault) const {
    std::vector<Eigen::Vector3d> corners;
    for (const int n : mesh_.mesh.tetrahedra.col(t)) {
      if (n >= 0 && n < mesh_.mesh.node_count() && mesh_.mesh.nodes.col(n).allFinite())
        corners.push_back(mesh_.mesh.nodes.col(n));
    }
    show(corners, fault);
  }

  /// Remainder of a degenerate cell: four corners are a tetrahedron, three a triangle.
  static void show(const std::vector<Eigen::Vector3d>& corners, Fault& fault) {
    if (corners.empty()) return;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : corners) centre += p / static_cast<double>(corners.size());
    fault.points.push_back(centre);
    Eigen::Matrix3Xd face(3, 3);
    for (const auto& f : kFaces) {
      if (corners.size() != 4) break;
      face << corners[f[0]], corners[f[1]], corners[f[2]];
      fault.faces.push_back(face);
    }
    if (corners.size() == 3) {
      face << corners[0], corners[1], corners[2];
      fault.faces.push_back(face);
    }
    if (corners.size() == 2) fault.lines.emplace_back(corners[0], corners[1]);
  }

  void add_elements(const std::string& kind, const std::string& what,
                    const std::vector<int>& tetrahedra, Severity severity = Severity::kError) {
    if (tetrahedra.empty()) return;
    Fault fault;
    fault.kind = kind;
    fault.text = what;
    fault.severity = severity;
    for (const int t : tetrahedra) {
      fault.numbers.push_back(mesh_.tetrahedron_number(t));
      show(t, fault);
    }
    faults_.push_back(std::move(fault));
  }

  void add_nodes(const std::string& kind, const std::string& what, const std::vector<int>& nodes) {
    if (nodes.empty()) return;
    Fault fault;
    fault.kind = kind;
    fault.text = what;
    for (const int n : nodes) {
      fault.numbers.push_back(mesh_.node_number(n));
      if (mesh_.mesh.nodes.col(n).allFinite()) fault.points.push_back(mesh_.mesh.nodes.col(n));
    }
    faults_.push_back(std::move(fault));
  }

  /// A nonexistent node can only be shown by the elements that reference it.
  void show_neighbours_of_bad_nodes() {
    if (report_.not_finite.empty()) return;
    Fault& fault = faults_.back();
    for (int t = 0; t < mesh_.mesh.tetrahedron_count(); ++t) {
      const auto c = mesh_.mesh.tetrahedra.col(t);
      if (std::any_of(c.begin(), c.end(), [this](int n) {
            return std::binary_search(report_.not_finite.begin(), report_.not_finite.end(), n);
          }))
        show(t, fault);
    }
  }

  void add_others() {
    Fault fault;
    fault.kind = "mixed";
    fault.text = "cells that are no tetrahedra (pyramids, prisms, hexahedra)";
    for (const mesh::OtherCell& cell : mesh_.others) {
      fault.numbers.push_back(cell.number);
      add_rim(cell, fault);
    }
    if (!fault.numbers.empty()) faults_.push_back(std::move(fault));
  }

  void add_rim(const mesh::OtherCell& cell, Fault& fault) const {
    static const std::map<int, std::vector<std::array<int, 2>>> kEdges{
        {5, {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}}},
        {6, {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}},
        {8,
         {{0, 1},
          {1, 2},
          {2, 3},
          {3, 0},
          {4, 5},
          {5, 6},
          {6, 7},
          {7, 4},
          {0, 4},
          {1, 5},
          {2, 6},
          {3, 7}}}};
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    int count = 0;
    for (const auto& [a, b] : kEdges.at(cell.corner_count)) {
      const int m = cell.corners[a], n = cell.corners[b];
      if (m < 0 || n < 0) continue;
      const Eigen::Vector3d from = mesh_.mesh.nodes.col(m), to = mesh_.mesh.nodes.col(n);
      if (!from.allFinite() || !to.allFinite()) continue;
      fault.lines.emplace_back(from, to);
      centre += 0.5 * (from + to);
      ++count;
    }
    if (count > 0) fault.points.push_back(centre / count);
  }

  /// Duplicates are distinguished from other overlapping elements.
  void add_repeated() {
    std::map<std::array<int, 4>, std::vector<int>> known;
    for (int t = 0; t < mesh_.mesh.tetrahedron_count(); ++t) {
      std::array<int, 4> c{};
      std::copy_n(mesh_.mesh.tetrahedra.col(t).begin(), 4, c.begin());
      std::sort(c.begin(), c.end());
      known[c].push_back(t);
    }
    std::vector<int> again;
    std::set<int> twice;
    for (const auto& [c, at] : known) {
      if (at.size() < 2) continue;
      again.insert(again.end(), at.begin() + 1, at.end());
      twice.insert(at.begin(), at.end());
    }
    std::sort(again.begin(), again.end());
    add_elements("repeated", "tetrahedra that are there twice", again);
    // Neighbours of a duplicate overlap its copy: not reported if this explains all overlaps.
    mesh::TetrahedralMesh once = mesh_.mesh;
    std::vector<int> index;
    for (int t = 0; t < mesh_.mesh.tetrahedron_count(); ++t) {
      if (!std::binary_search(again.begin(), again.end(), t)) index.push_back(t);
    }
    once.tetrahedra = mesh_.mesh.tetrahedra(Eigen::all, index);
    if (again.empty()) {
      overlapping_ = report_.overlapping;
    } else {
      for (const int t : mesh::check(once).overlapping) overlapping_.push_back(index[t]);
    }
    // A flat element lies on its neighbours, which is reported already.
    const auto is_flat = [this](int t) {
      return std::binary_search(report_.zero_volume.begin(), report_.zero_volume.end(), t);
    };
    if (std::any_of(overlapping_.begin(), overlapping_.end(), is_flat)) {
      std::vector<int> full;
      for (const int t : index) {
        if (!is_flat(t)) full.push_back(t);
      }
      once.tetrahedra = mesh_.mesh.tetrahedra(Eigen::all, full);
      overlapping_.clear();
      for (const int t : mesh::check(once).overlapping) overlapping_.push_back(full[t]);
    }
  }

  void add_parts() {
    const std::vector<int> parts = mesh::parts_by_faces(mesh_.mesh);
    const int count = parts.empty() ? 0 : 1 + *std::max_element(parts.begin(), parts.end());
    if (count < 2) return;
    std::vector<int> small;
    for (std::size_t t = 0; t < parts.size(); ++t) {
      if (parts[t] > 0) small.push_back(static_cast<int>(t));
    }
    const bool apart = report_.parts == count;
    std::ostringstream what;
    what << "tetrahedra that are not of the largest of " << count << " parts, which "
         << (apart ? "do not touch" : "share no face: they hang on hinges without stiffness");
    add_elements(apart ? "parts" : "hinged_parts", what.str(), small);
  }

  void add_hinges() {
    if (report_.non_manifold_edges == 0 && report_.non_manifold_nodes == 0) return;
    const mesh::Surface surface =
        mesh::extract_surface(make_element_mesh(mesh_.mesh, mesh::ElementOrder::kLinear));
    std::map<std::pair<int, int>, int> edges;
    for (int t = 0; t < surface.triangles.cols(); ++t) {
      for (int i = 0; i < 3; ++i)
        ++edges[std::minmax({surface.triangles(i, t), surface.triangles((i + 1) % 3, t)})];
    }
    Fault fault;
    fault.kind = "hinge";
    fault.severity = Severity::kWarning;
    std::ostringstream what;
    what << "the surface touches itself in " << report_.non_manifold_edges << " edges and "
         << report_.non_manifold_nodes << " nodes";
    fault.text = what.str();
    for (const auto& [edge, count] : edges) {
      if (count == 2) continue;
      const Eigen::Vector3d a = mesh_.mesh.nodes.col(edge.first),
                            b = mesh_.mesh.nodes.col(edge.second);
      fault.lines.emplace_back(a, b);
      fault.points.push_back(0.5 * (a + b));
    }
    if (fault.points.empty()) mark_pinched(surface, fault);
    faults_.push_back(std::move(fault));
  }

  /// Nodes whose triangles form more than one fan: the edges of the fans are not connected.
  void mark_pinched(const mesh::Surface& surface, Fault& fault) const {
    std::map<int, std::map<int, int>> parents;
    const auto root = [](std::map<int, int>& parent, int n) {
      while (parent[n] != n) n = parent[n];
      return n;
    };
    for (int t = 0; t < surface.triangles.cols(); ++t) {
      for (int i = 0; i < 3; ++i) {
        auto& parent = parents[surface.triangles(i, t)];
        const int a = surface.triangles((i + 1) % 3, t), b = surface.triangles((i + 2) % 3, t);
        parent.emplace(a, a);
        parent.emplace(b, b);
        parent[root(parent, a)] = root(parent, b);
      }
    }
    for (auto& [n, parent] : parents) {
      const auto fans = std::count_if(parent.begin(), parent.end(),
                                      [](const auto& p) { return p.first == p.second; });
      if (fans > 1) fault.points.push_back(mesh_.mesh.nodes.col(n));
    }
  }

  const mesh::MeshWithGroups& mesh_;
  mesh::MeshReport report_;
  std::vector<int> overlapping_;
  std::vector<Fault> faults_;
};

}  // namespace

std::vector<Fault> find_faults(const mesh::MeshWithGroups& mesh) {
  return VolumeFaults(mesh).find();
}

}  // namespace palpate::mesh_tool
