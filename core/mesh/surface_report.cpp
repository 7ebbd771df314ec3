#include "core/mesh/surface_report.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <set>

#include "core/mesh/near_nodes.hpp"
#include "core/mesh/surface_topology.hpp"
#include "core/mesh/triangle_intersections.hpp"

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;

constexpr double kNoArea = 1e-9, kSame = 1e-9;

void find_bad_numbers(const TriangleSurface& surface, SurfaceReport& report) {
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const auto c = surface.triangles.col(t);
    if (c.minCoeff() < 0 || c.maxCoeff() >= surface.point_count())
      report.index_out_of_range.push_back(t);
  }
  for (int n = 0; n < surface.point_count(); ++n) {
    if (!surface.points.col(n).allFinite()) report.not_finite.push_back(n);
  }
}

void look_at_triangles(const TriangleSurface& surface, SurfaceReport& report) {
  std::vector<bool> used(surface.point_count(), false);
  std::set<std::array<int, 3>> known;
  report.shortest_edge = std::numeric_limits<double>::infinity();
  for (int t = 0; t < surface.triangle_count(); ++t) {
    std::array<int, 3> c{};
    double longest = 0;
    for (int i = 0; i < 3; ++i) {
      c[i] = surface.triangles(i, t);
      used[c[i]] = true;
      const double length =
          (surface.points.col(surface.triangles((i + 1) % 3, t)) - surface.points.col(c[i])).norm();
      longest = std::max(longest, length);
      report.shortest_edge = std::min(report.shortest_edge, length);
    }
    report.longest_edge = std::max(report.longest_edge, longest);
    const Vector3d a = surface.points.col(c[0]), b = surface.points.col(c[1]),
                   d = surface.points.col(c[2]);
    const double area = 0.5 * (b - a).cross(d - a).norm();
    report.area += area;
    if (!(2 * area > kNoArea * longest * longest)) report.no_area.push_back(t);
    std::sort(c.begin(), c.end());
    if (!known.insert(c).second) report.repeated.push_back(t);
  }
  for (int n = 0; n < surface.point_count(); ++n) {
    if (!used[n]) report.unused_points.push_back(n);
  }
}

/// Points whose triangles form more than one fan connected by edges.
std::vector<int> pinched_points(const TriangleSurface& surface) {
  std::vector<std::vector<SurfaceEdge>> opposite(surface.point_count());
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const auto c = surface.triangles.col(t);
    for (int i = 0; i < 3; ++i) opposite[c[i]].push_back({c[(i + 1) % 3], c[(i + 2) % 3]});
  }
  std::vector<int> pinched;
  for (int n = 0; n < surface.point_count(); ++n) {
    std::map<int, int> parent;
    const auto root = [&parent](int p) {
      while (parent[p] != p) p = parent[p];
      return p;
    };
    for (const auto& [a, b] : opposite[n]) {
      parent.emplace(a, a);
      parent.emplace(b, b);
      parent[root(a)] = root(b);
    }
    const auto fans = std::count_if(parent.begin(), parent.end(),
                                    [](const auto& p) { return p.first == p.second; });
    if (fans > 1) pinched.push_back(n);
  }
  return pinched;
}

/// Solid angle of a triangle seen from a point, divided by 4 pi (van Oosterom and Strackee 1983).
double winding(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double over = a.dot(b.cross(c));
  const double under = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return std::atan2(over, under) / (2 * EIGEN_PI);
}

/// Determines the nesting of the parts, and inward orientation, once each part is consistently
/// oriented.
void nest(const TriangleSurface& turned, SurfaceReport& report) {
  const int parts = 1 + *std::max_element(report.part.begin(), report.part.end());
  report.depth.assign(parts, 0);
  std::vector<double> volumes(parts, 0);
  std::vector<Vector3d> seat(parts);  // one point of each part
  std::vector<bool> has_seat(parts, false);
  const Vector3d origin = turned.points.rowwise().mean();
  const auto corner = [&](int i, int t) -> Vector3d {
    return turned.points.col(turned.triangles(i, t));
  };
  for (int t = 0; t < turned.triangle_count(); ++t) {
    const int p = report.part[t];
    volumes[p] +=
        (corner(0, t) - origin).dot((corner(1, t) - origin).cross(corner(2, t) - origin)) / 6;
    if (!has_seat[p]) seat[p] = (corner(0, t) + corner(1, t) + corner(2, t)) / 3;
    has_seat[p] = true;
  }
  for (int p = 0; p < parts && parts > 1; ++p) {
    std::vector<double> around(parts, 0);
    for (int t = 0; t < turned.triangle_count(); ++t) {
      if (report.part[t] == p) continue;
      around[report.part[t]] +=
          winding(corner(0, t) - seat[p], corner(1, t) - seat[p], corner(2, t) - seat[p]);
    }
    for (const double w : around) report.depth[p] += std::abs(w) > 0.5 ? 1 : 0;
  }
  for (int p = 0; p < parts; ++p) {
    const bool is_cavity = report.depth[p] % 2 == 1;
    report.bodies += is_cavity ? 0 : 1;
    report.volume += is_cavity ? -std::abs(volumes[p]) : std::abs(volumes[p]);
    if ((volumes[p] < 0) != is_cavity) report.inside_out.push_back(p);
  }
}

}  // namespace

SurfaceReport check(const TriangleSurface& surface) {
  SurfaceReport report;
  report.point_count = surface.point_count();
  report.triangle_count = surface.triangle_count();
  find_bad_numbers(surface, report);
  if (!report.index_out_of_range.empty() || !report.not_finite.empty()) return report;
  if (surface.triangle_count() == 0) return report;
  look_at_triangles(surface, report);
  const std::vector<int> by = near_nodes(surface.points, kSame * diagonal(surface.points));
  for (int n = 0; n < surface.point_count(); ++n) {
    if (by[n] != n) report.duplicate_points.push_back(n);
  }
  const SurfaceTopology topology(surface);
  report.holes = topology.holes();
  report.non_manifold_edges = topology.crowded_edges();
  report.non_manifold_points = pinched_points(surface);
  const SurfaceSides sides = topology.sides();
  report.part = sides.part;
  report.one_sided = sides.one_sided;
  TriangleSurface turned = surface;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (!sides.turned[t]) continue;
    report.turned.push_back(t);
    std::swap(turned.triangles(1, t), turned.triangles(2, t));
  }
  report.intersections = find_intersections(surface);
  report.depth.assign(1 + *std::max_element(report.part.begin(), report.part.end()), 0);
  if (report.is_closed() && report.one_sided.empty()) nest(turned, report);
  return report;
}

bool SurfaceReport::ok() const {
  return triangle_count > 0 && index_out_of_range.empty() && not_finite.empty() &&
         no_area.empty() && repeated.empty() && duplicate_points.empty() && unused_points.empty() &&
         is_closed() && non_manifold_points.empty() && turned.empty() && one_sided.empty() &&
         inside_out.empty() && intersections.empty() && bodies == 1;
}

}  // namespace palpate::mesh
