#include "tools/mesh/quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <set>
#include <sstream>
#include <stdexcept>

#include "core/mesh/connectivity.hpp"
#include "core/mesh/report.hpp"
#include "core/mesh/tetrahedron_quality.hpp"
#include "tools/common/table.hpp"

namespace palpate::mesh_tool {
namespace {

constexpr double kDegrees = 180 / EIGEN_PI;

std::string number(double value, int digits = 4) {
  return common::formatted("%.*g", digits, value);
}

std::vector<double> edge_lengths(const mesh::TetrahedralMesh& mesh) {
  std::set<std::pair<int, int>> edges;
  for (int t = 0; t < mesh.tetrahedron_count(); ++t) {
    for (const auto& [a, b] : mesh::kTetrahedronEdges)
      edges.insert(std::minmax({mesh.tetrahedra(a, t), mesh.tetrahedra(b, t)}));
  }
  std::vector<double> lengths;
  for (const auto& [a, b] : edges)
    lengths.push_back((mesh.nodes.col(a) - mesh.nodes.col(b)).norm());
  return lengths;
}

}  // namespace

double Distribution::least() const {
  return values.empty() ? 0 : *std::min_element(values.begin(), values.end());
}
double Distribution::mean() const {
  return values.empty() ? 0
                        : std::accumulate(values.begin(), values.end(), 0.0) /
                              static_cast<double>(values.size());
}
double Distribution::most() const {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

const Distribution& Quality::of(const std::string& key) const {
  for (const Distribution& d : distributions) {
    if (d.key == key) return d;
  }
  throw std::out_of_range(key);
}

Quality measure_quality(const mesh::TetrahedralMesh& mesh) {
  Quality quality;
  quality.nodes = mesh.node_count();
  quality.elements = mesh.tetrahedron_count();
  if (quality.elements == 0) return quality;
  const mesh::MeshReport report = mesh::check(mesh);
  quality.parts = report.parts;
  quality.hinge_edges = static_cast<int>(report.non_manifold_edges.size());
  quality.hinge_nodes = static_cast<int>(report.non_manifold_nodes.size());
  quality.volume = report.volume;
  quality.lower = mesh.nodes.rowwise().minCoeff();
  quality.upper = mesh.nodes.rowwise().maxCoeff();
  const mesh::Surface surface = mesh::extract_surface(mesh);
  quality.surface_nodes = static_cast<int>(surface.nodes.size());
  quality.surface_triangles = static_cast<int>(surface.triangles.cols());
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d a = mesh.nodes.col(surface.triangles(0, t)),
                          b = mesh.nodes.col(surface.triangles(1, t)),
                          c = mesh.nodes.col(surface.triangles(2, t));
    quality.area += 0.5 * (b - a).cross(c - a).norm();
  }
  Distribution volumes{"volume of an element, m^3", "element_volume_m3", {}},
      edges{"edge length, m", "edge_m", {}},
      smallest{"smallest dihedral angle, deg", "smallest_angle_deg", {}},
      largest{"largest dihedral angle, deg", "largest_angle_deg", {}},
      ratio{"radius ratio", "radius_ratio", {}}, jacobian{"scaled Jacobian", "scaled_jacobian", {}},
      stiffness{"stiffness by a regular one's", "relative_stiffness", {}};
  for (int t = 0; t < quality.elements; ++t) {
    const mesh::TetrahedronQuality q = mesh::measure(mesh, t);
    volumes.values.push_back(q.volume);
    smallest.values.push_back(kDegrees * q.smallest_angle);
    largest.values.push_back(kDegrees * q.largest_angle);
    ratio.values.push_back(q.radius_ratio);
    jacobian.values.push_back(q.scaled_jacobian);
    stiffness.values.push_back(q.stiffness);
  }
  edges.values = edge_lengths(mesh);
  quality.quadratic_nodes = quality.nodes + static_cast<int>(edges.values.size());
  quality.distributions = {volumes, edges, smallest, largest, ratio, jacobian, stiffness};
  return quality;
}

std::string text(const Quality& quality) {
  std::ostringstream out;
  const Eigen::Vector3d size = quality.upper - quality.lower;
  out << quality.nodes << " nodes (" << quality.quadratic_nodes << " at order 2), "
      << quality.elements << " tetrahedra; surface of " << quality.surface_nodes << " nodes, "
      << quality.surface_triangles << " triangles; "
      << (quality.parts == 1 ? "one part" : std::to_string(quality.parts) + " parts") << "; "
      << (quality.hinge_edges + quality.hinge_nodes == 0
              ? "manifold surface"
              : "surface touches itself in " + std::to_string(quality.hinge_edges) + " edges and " +
                    std::to_string(quality.hinge_nodes) + " nodes")
      << "\nvolume " << number(quality.volume, 6) << " m^3, area " << number(quality.area)
      << " m^2, box " << number(size.x()) << " x " << number(size.y()) << " x " << number(size.z())
      << " m\n";
  constexpr char kRow[] = "%-30s %11s %11s %11s\n";
  out << common::formatted(kRow, "", "least", "mean", "most");
  for (const Distribution& d : quality.distributions)
    out << common::formatted(kRow, d.name.c_str(), number(d.least()).c_str(),
                             number(d.mean()).c_str(), number(d.most()).c_str());
  return out.str();
}

nlohmann::json to_json(const Quality& quality) {
  nlohmann::json json{{"nodes", quality.nodes},
                      {"nodes_at_order_2", quality.quadratic_nodes},
                      {"tetrahedra", quality.elements},
                      {"surface_nodes", quality.surface_nodes},
                      {"surface_triangles", quality.surface_triangles},
                      {"parts", quality.parts},
                      {"non_manifold_edges", quality.hinge_edges},
                      {"non_manifold_nodes", quality.hinge_nodes},
                      {"volume_m3", quality.volume},
                      {"area_m2", quality.area},
                      {"lower_m", {quality.lower.x(), quality.lower.y(), quality.lower.z()}},
                      {"upper_m", {quality.upper.x(), quality.upper.y(), quality.upper.z()}}};
  for (const Distribution& d : quality.distributions) {
    // Infinity, for flat elements, becomes null.
    json[d.key] = {{"least", d.least()}, {"mean", d.mean()}, {"most", d.most()}};
  }
  return json;
}

std::string compare(const Quality& before, const Quality& after) {
  if (before.elements == 0 || after.elements == 0) return "";
  std::ostringstream out;
  const auto line = [&](const std::string& key, const char* what, bool least) {
    const Distribution &from = before.of(key), &to = after.of(key);
    out << what << ' ' << number(least ? from.least() : from.most(), 3) << " -> "
        << number(least ? to.least() : to.most(), 3) << " (mean " << number(from.mean(), 3)
        << " -> " << number(to.mean(), 3) << ")";
  };
  line("radius_ratio", "radius ratio at least", true);
  out << "; ";
  line("smallest_angle_deg", "dihedral angle at least", true);
  out << "; ";
  line("relative_stiffness", "stiffness at most", false);
  return out.str();
}

}  // namespace palpate::mesh_tool
