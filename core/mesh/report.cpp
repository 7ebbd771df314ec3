#include "core/mesh/report.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <utility>

#include "core/mesh/surface.hpp"

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

/// Coincident nodes, found among neighbours along a direction that is not normal to grid planes:
/// along an axis, a grid of a million nodes has ten thousand at every coordinate.
std::vector<int> find_duplicates(const Eigen::Matrix3Xd& nodes) {
  const int count = static_cast<int>(nodes.cols());
  const double tolerance = 1e-9 * (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).norm();
  const Eigen::Vector3d line = Eigen::Vector3d(1, std::sqrt(2) - 1, std::sqrt(3) - 1).normalized();
  const Eigen::VectorXd place = nodes.transpose() * line;
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&place](int a, int b) {
    return std::make_pair(place[a], a) < std::make_pair(place[b], b);
  });
  std::vector<bool> marked(count, false);
  for (int i = 0; i < count; ++i) {
    // nodes already marked are skipped: of many coincident nodes, only one is compared with all
    for (int j = i + 1; j < count && !marked[order[i]]; ++j) {
      if (!(place[order[j]] - place[order[i]] <= tolerance)) break;
      if ((nodes.col(order[i]) - nodes.col(order[j])).norm() <= tolerance) {
        marked[std::max(order[i], order[j])] = true;
      }
    }
  }
  std::vector<int> duplicates;
  for (int n = 0; n < count; ++n) {
    if (marked[n]) duplicates.push_back(n);
  }
  return duplicates;
}

int count_parts(const TetrahedralMesh& mesh) {
  std::vector<int> parent(mesh.node_count());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&parent](int n) {
    while (parent[n] != n) n = parent[n] = parent[parent[n]];
    return n;
  };
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    for (int i = 1; i < 4; ++i) {
      parent[root(mesh.tetrahedra(i, t))] = root(mesh.tetrahedra(0, t));
    }
  }
  std::vector<bool> used(mesh.node_count(), false);
  for (int i = 0; i < mesh.tetrahedra.size(); ++i) used[mesh.tetrahedra(i)] = true;
  int parts = 0;
  for (int n = 0; n < mesh.node_count(); ++n) parts += used[n] && parent[n] == n;
  return parts;
}

int count_non_manifold_edges(const Surface& surface) {
  std::map<std::pair<int, int>, int> triangles;
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i) {
      ++triangles[std::minmax({surface.triangles(i, t), surface.triangles((i + 1) % 3, t)})];
    }
  }
  return static_cast<int>(std::count_if(triangles.begin(), triangles.end(),
                                        [](const auto& edge) { return edge.second != 2; }));
}

/// Surface nodes whose triangles form more than one fan: parts touch in this point.
int count_non_manifold_nodes(const Surface& surface) {
  std::map<int, std::map<int, int>> around;  // of a node: each neighbour's root
  const auto root = [](std::map<int, int>& parent, int n) {
    while (parent[n] != n) n = parent[n];
    return n;
  };
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    for (int i = 0; i < 3; ++i) {
      std::map<int, int>& parent = around[surface.triangles(i, t)];
      const int a = surface.triangles((i + 1) % 3, t), b = surface.triangles((i + 2) % 3, t);
      parent.emplace(a, a);
      parent.emplace(b, b);
      parent[root(parent, a)] = root(parent, b);
    }
  }
  return static_cast<int>(std::count_if(around.begin(), around.end(), [](const auto& node) {
    return std::count_if(node.second.begin(), node.second.end(), [](const auto& neighbour) {
             return neighbour.first == neighbour.second;
           }) > 1;
  }));
}

/// Tetrahedra at a face shared by more than two, or by two on the same side of it: they overlap.
std::vector<int> find_overlapping(const TetrahedralMesh& mesh) {
  std::map<std::array<int, 3>, std::vector<int>> faces;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    for (int left_out = 0; left_out < 4; ++left_out) {
      std::array<int, 3> face;
      for (int i = 0, k = 0; i < 4; ++i) {
        if (i != left_out) face[k++] = mesh.tetrahedra(i, t);
      }
      std::sort(face.begin(), face.end());
      faces[face].push_back(t);
    }
  }
  std::set<int> overlapping;
  for (const auto& [face, at] : faces) {
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
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    const auto indices = mesh.tetrahedra.col(t);
    if (indices.minCoeff() < 0 || indices.maxCoeff() >= mesh.node_count()) {
      report.index_out_of_range.push_back(t);
    }
  }
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (!mesh.nodes.col(n).allFinite()) report.not_finite.push_back(n);
  }
  if (!report.index_out_of_range.empty() || !report.not_finite.empty()) return report;
  if (mesh.node_count() == 0 || mesh.tetrahedron_count() == 0) return report;

  std::vector<bool> used(mesh.node_count(), false);
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
    for (int i = 0; i < 4; ++i) used[mesh.tetrahedra(i, t)] = true;
  }
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (!used[n]) report.unused_nodes.push_back(n);
  }
  report.duplicate_nodes = find_duplicates(mesh.nodes);
  report.parts = count_parts(mesh);
  report.overlapping = find_overlapping(mesh);
  const Surface surface = extract_surface(make_element_mesh(mesh, ElementOrder::kLinear));
  report.non_manifold_edges = count_non_manifold_edges(surface);
  report.non_manifold_nodes = count_non_manifold_nodes(surface);
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
  if (non_manifold_edges > 0) text << "; " << non_manifold_edges << " non-manifold surface edges";
  if (non_manifold_nodes > 0) text << "; " << non_manifold_nodes << " non-manifold surface nodes";
  return text.str();
}

}  // namespace palpate::mesh
