#include "core/mesh/report.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <sstream>

#include "core/mesh/connectivity.hpp"
#include "core/mesh/near_nodes.hpp"

namespace palpate::mesh {
namespace {

double longest_edge(const TetrahedralMesh& mesh, int t) {
  double longest = 0;
  for (const auto& edge : kTetrahedronEdges) {
    const Eigen::Vector3d a = mesh.nodes.col(mesh.tetrahedra(edge[0], t));
    longest = std::max(longest, (mesh.nodes.col(mesh.tetrahedra(edge[1], t)) - a).norm());
  }
  return longest;
}

int count_parts(const TetrahedralMesh& mesh, const std::vector<bool>& used) {
  DisjointSets sets(mesh.node_count());
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    for (int i = 1; i < 4; ++i) sets.join(mesh.tetrahedra(i, t), mesh.tetrahedra(0, t));
  }
  int parts = 0;
  for (int n = 0; n < mesh.node_count(); ++n) parts += used[n] && sets.root(n) == n;
  return parts;
}

/// Tetrahedra at a face shared by more than two, or by two on the same side of it: they overlap.
std::vector<int> find_overlapping(const TetrahedralMesh& mesh) {
  std::set<int> overlapping;
  for (const auto& [face, at] : tetrahedra_by_face(mesh)) {
    const auto side = [&mesh, &face = face](int t) {  // of the face
      const Eigen::Vector3d a = mesh.nodes.col(face[0]);
      const Eigen::Vector3d normal =
          (mesh.nodes.col(face[1]) - a).cross(mesh.nodes.col(face[2]) - a);
      return normal.dot(mesh.nodes(Eigen::all, mesh.tetrahedra.col(t)).rowwise().mean() - a) > 0;
    };
    if (at.size() < 2 || (at.size() == 2 && side(at[0]) != side(at[1]))) continue;
    overlapping.insert(at.begin(), at.end());
  }
  return {overlapping.begin(), overlapping.end()};
}

void append(std::ostream& text, const std::vector<int>& indices, const std::string& what) {
  if (indices.empty()) return;
  constexpr std::size_t kShown = 5;
  text << "; " << indices.size() << " " << what << " (";
  for (std::size_t i = 0; i < std::min(kShown, indices.size()); ++i) {
    text << (i > 0 ? ", " : "") << indices[i];
  }
  text << (indices.size() > kShown ? ", ...)" : ")");
}

}  // namespace

double radius_ratio(const TetrahedralMesh& mesh, int t) {
  const double v = std::abs(volume(mesh, t));
  std::array<Eigen::Vector3d, 4> x;
  for (int i = 0; i < 4; ++i) x[i] = mesh.nodes.col(mesh.tetrahedra(i, t));
  const Eigen::Vector3d a = x[1] - x[0], b = x[2] - x[0], c = x[3] - x[0];
  const double area = 0.5 * (a.cross(b).norm() + b.cross(c).norm() + c.cross(a).norm() +
                             (b - a).cross(c - a).norm());
  // r_in = 3 V / area; r_out = |a^2 (b x c) + b^2 (c x a) + c^2 (a x b)| / (12 V).
  const double twelve_v_r_out =
      (a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b))
          .norm();
  return area > 0 && twelve_v_r_out > 0 ? 108 * v * v / (area * twelve_v_r_out) : 0;
}

MeshReport check(const TetrahedralMesh& mesh) {
  MeshReport report;
  report.node_count = mesh.node_count();
  report.tetrahedron_count = mesh.tetrahedron_count();
  report.index_out_of_range = out_of_range(mesh.tetrahedra, mesh.node_count());
  report.not_finite = not_finite(mesh.nodes);
  if (!report.index_out_of_range.empty() || !report.not_finite.empty()) return report;
  if (mesh.node_count() == 0 || mesh.tetrahedron_count() == 0) return report;

  report.quality_min = 1;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    const double v = volume(mesh, t);
    // also true if sizes are so large that the volume is not finite
    if (!(std::abs(v) > 1e-12 * std::pow(longest_edge(mesh, t), 3))) {
      report.zero_volume.push_back(t);
    } else if (v < 0) {
      report.negative_volume.push_back(t);
    }
    report.volume += v;
    const double quality = radius_ratio(mesh, t);
    report.quality_min = std::min(report.quality_min, quality);
    report.quality_mean += quality / mesh.tetrahedron_count();
  }
  const std::vector<bool> used = used_nodes(mesh.tetrahedra, mesh.node_count());
  report.unused_nodes = indices_of(used, false);
  report.duplicate_nodes = duplicates(mesh.nodes, 1e-9 * diagonal(mesh.nodes));
  report.parts = count_parts(mesh, used);
  report.overlapping = find_overlapping(mesh);
  const Eigen::Matrix3Xi surface = extract_surface(mesh).triangles;
  for (const auto& [edge, triangles] : triangles_by_edge(surface)) {
    if (triangles.size() != 2) report.non_manifold_edges.push_back(edge);
  }
  report.non_manifold_nodes = pinched_nodes(surface);
  return report;
}

bool MeshReport::ok() const {
  return tetrahedron_count > 0 && index_out_of_range.empty() && not_finite.empty() &&
         zero_volume.empty() && negative_volume.empty() && duplicate_nodes.empty() &&
         unused_nodes.empty() && overlapping.empty() && parts == 1;
}

std::string MeshReport::text() const {
  std::ostringstream text;
  text.precision(4);
  text << node_count << " nodes, " << tetrahedron_count << " tetrahedra, volume " << volume
       << " m^3, quality " << quality_min << " at least, " << quality_mean << " on average";
  append(text, index_out_of_range, "tetrahedra with an index out of range");
  append(text, not_finite, "nodes that are not finite");
  append(text, zero_volume, "tetrahedra without volume");
  append(text, negative_volume, "tetrahedra turned inside out");
  append(text, duplicate_nodes, "nodes on top of another");
  append(text, unused_nodes, "nodes in no tetrahedron");
  append(text, overlapping, "tetrahedra that overlap a neighbour");
  if (parts > 1) text << "; " << parts << " parts that do not touch";
  if (!non_manifold_edges.empty())
    text << "; " << non_manifold_edges.size() << " non-manifold surface edges";
  if (!non_manifold_nodes.empty())
    text << "; " << non_manifold_nodes.size() << " non-manifold surface nodes";
  return text.str();
}

}  // namespace palpate::mesh
