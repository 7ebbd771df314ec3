#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <sstream>

#include "core/mesh/near_nodes.hpp"
#include "core/mesh/repair.hpp"
#include "core/mesh/report.hpp"
#include "tools/mesh/fault_finder.hpp"

namespace palpate::mesh_tool {
namespace {

constexpr double kSliver = 0.02;  // radius ratio

/// Edges of a pyramid (5 corners), prism (6) or hexahedron (8).
std::vector<mesh::Edge> edges_of(int corners) {
  const int sides = corners == 6 ? 3 : 4;
  std::vector<mesh::Edge> edges;
  for (int i = 0; i < sides; ++i) {
    const int next = (i + 1) % sides;
    edges.push_back({i, next});
    edges.push_back({i, corners == 5 ? 4 : sides + i});
    if (corners != 5) edges.push_back({sides + i, sides + next});
  }
  return edges;
}

class VolumeFaults : FaultFinder {
 public:
  explicit VolumeFaults(const mesh::MeshWithGroups& mesh)
      : FaultFinder(
            mesh.mesh.nodes, mesh.mesh.tetrahedra,
            [&mesh](int t) { return mesh.tetrahedron_number(t); },
            [&mesh](int n) { return mesh.node_number(n); }),
        mesh_(mesh),
        report_(mesh::check(mesh.mesh)) {}

  std::vector<Fault> find() {
    if (mesh_.mesh.tetrahedron_count() == 0 && mesh_.others.empty())
      start("empty", "there are no tetrahedra");
    add_others();
    add_cells("out_of_range", "tetrahedra that name a node which is not there",
              report_.index_out_of_range);
    add_points("not_finite", "nodes with a coordinate that is not finite", report_.not_finite);
    // A nonexistent node can only be shown by the elements that reference it.
    for (const int t : cells_at(report_.not_finite)) show(t, faults_.back());
    if (report_.index_out_of_range.empty() && report_.not_finite.empty()) add_geometry();
    add_size();
    return std::move(faults_);
  }

 private:
  void add_geometry() {
    add_cells("inverted", "tetrahedra turned inside out", report_.negative_volume);
    add_cells("flat", "tetrahedra without volume", report_.zero_volume);
    add_repeated();
    add_cells("overlap", "tetrahedra that overlap a neighbour", overlapping_);
    add_points("duplicate_node", "nodes that lie on another", report_.duplicate_nodes);
    add_points("unused_node", "nodes in no tetrahedron", report_.unused_nodes);
    add_parts();
    add_hinges();
    std::vector<int> slivers;
    const std::set<int> flat(report_.zero_volume.begin(), report_.zero_volume.end());
    for (int t = 0; t < mesh_.mesh.tetrahedron_count(); ++t) {
      if (flat.count(t) == 0 && mesh::radius_ratio(mesh_.mesh, t) < kSliver) slivers.push_back(t);
    }
    add_cells("sliver", "slivers: tetrahedra with a radius ratio below 0.02", slivers,
              Severity::kWarning);
  }

  void add_others() {
    if (mesh_.others.empty()) return;
    Fault& fault = start("mixed", "cells that are no tetrahedra (pyramids, prisms, hexahedra)");
    for (const mesh::OtherCell& cell : mesh_.others) {
      fault.numbers.push_back(cell.number);
      add_rim(cell, fault);
    }
  }

  void add_rim(const mesh::OtherCell& cell, Fault& fault) const {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    int count = 0;
    for (const auto& [a, b] : edges_of(cell.corner_count)) {
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
      known[mesh::sorted_corners(mesh_.mesh, t)].push_back(t);
    }
    std::vector<int> again;
    for (const auto& [c, at] : known) {
      if (at.size() < 2) continue;
      again.insert(again.end(), at.begin() + 1, at.end());
    }
    std::sort(again.begin(), again.end());
    add_cells("repeated", "tetrahedra that are there twice", again);
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
    add_cells(apart ? "parts" : "hinged_parts", what.str(), small);
  }

  void add_hinges() {
    const std::vector<mesh::Edge>& edges = report_.non_manifold_edges;
    const std::vector<int>& nodes = report_.non_manifold_nodes;
    if (edges.empty() && nodes.empty()) return;
    std::ostringstream what;
    what << "the surface touches itself in " << edges.size() << " edges and " << nodes.size()
         << " nodes";
    Fault& fault = start("hinge", what.str(), Severity::kWarning);
    show_edges(edges, fault);
    for (const int n : nodes) {
      if (edges.empty()) fault.points.emplace_back(mesh_.mesh.nodes.col(n));
    }
  }

  const mesh::MeshWithGroups& mesh_;
  mesh::MeshReport report_;
  std::vector<int> overlapping_;
};

}  // namespace

std::vector<Fault> find_faults(const mesh::MeshWithGroups& mesh) {
  return VolumeFaults(mesh).find();
}

}  // namespace palpate::mesh_tool
