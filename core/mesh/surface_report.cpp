#include "core/mesh/surface_report.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/mesh/near_nodes.hpp"
#include "core/mesh/surface_topology.hpp"

namespace palpate::mesh {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<Vector3d, 3>;

/// relative to the size of the two triangles: smaller lengths are rounding errors
constexpr double kRounding = 1e-9;

struct Candidate {
  Triangle x;
  Eigen::Vector3i corners;
  Vector3d normal;  // unit normal
  Eigen::AlignedBox3d box;
  double size = 0;  // longest edge
};

/// Whether a point in the triangle's plane lies inside it, by more than `margin` from its edges.
bool is_within(const Candidate& c, const Vector3d& p, double margin) {
  for (int i = 0; i < 3; ++i) {
    const Vector3d along = (c.x[(i + 1) % 3] - c.x[i]).normalized();
    if (c.normal.cross(along).dot(p - c.x[i]) <= margin) return false;
  }
  return true;
}

/// Whether a segment intersects the interior of a triangle, or touches it if `margin` < 0.
bool crosses(const Candidate& c, const Vector3d& from, const Vector3d& to, double rounding,
             double margin) {
  const double a = c.normal.dot(from - c.x[0]), b = c.normal.dot(to - c.x[0]);
  if ((a > rounding && b > rounding) || (a < -rounding && b < -rounding)) return false;
  if (std::abs(a) <= rounding && std::abs(b) <= rounding)
    return false;  // the segment lies in the plane
  const double share = std::clamp(a / (a - b), 0.0, 1.0);
  return is_within(c, from + share * (to - from), margin);
}

/// Whether coplanar triangles overlap: no edge of either separates them.
bool overlaps_in_plane(const Candidate& c, const Candidate& d, double rounding) {
  const auto parts = [rounding](const Candidate& one, const Candidate& other) {
    for (int i = 0; i < 3; ++i) {
      const Vector3d inward = one.normal.cross((one.x[(i + 1) % 3] - one.x[i]).normalized());
      double most = -INFINITY;
      for (const Vector3d& p : other.x) most = std::max(most, inward.dot(p - one.x[i]));
      if (most <= rounding) return true;
    }
    return false;
  };
  return !parts(c, d) && !parts(d, c);
}

bool intersect(const Candidate& c, const Candidate& d) {
  const double rounding = kRounding * std::max(c.size, d.size);
  std::vector<int> shared;
  for (const int n : c.corners) {
    if ((d.corners.array() == n).any()) shared.push_back(n);
  }
  const auto is_shared = [&shared](int n) {
    return std::find(shared.begin(), shared.end(), n) != shared.end();
  };
  if (shared.size() == 3) return true;  // identical triangles
  bool in_plane = true;
  for (const Vector3d& p : d.x) {
    in_plane = in_plane && std::abs(c.normal.dot(p - c.x[0])) <= rounding;
  }
  if (in_plane) return overlaps_in_plane(c, d, rounding);
  if (shared.size() == 2) return false;  // they meet in the edge only, folded or not
  // Triangles with a shared corner can intersect only in the opposite edges; touching counts for
  // triangles without shared corners.
  const double margin = shared.empty() ? -rounding : rounding;
  const auto goes_through = [&](const Candidate& one, const Candidate& other) {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      if (is_shared(one.corners[i]) || is_shared(one.corners[j])) continue;
      if (crosses(other, one.x[i], one.x[j], rounding, margin)) return true;
    }
    return false;
  };
  return goes_through(c, d) || goes_through(d, c);
}

constexpr double kNoArea = 1e-9, kSame = 1e-9;

void look_at_triangles(const TriangleSurface& surface, SurfaceReport& report) {
  std::set<std::array<int, 3>> known;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    std::array<int, 3> c{};
    double longest = 0;
    for (int i = 0; i < 3; ++i) {
      c[i] = surface.triangles(i, t);
      const double length =
          (surface.points.col(surface.triangles((i + 1) % 3, t)) - surface.points.col(c[i])).norm();
      longest = std::max(longest, length);
    }
    const Vector3d a = surface.points.col(c[0]), b = surface.points.col(c[1]),
                   d = surface.points.col(c[2]);
    const double area = 0.5 * (b - a).cross(d - a).norm();
    report.area += area;
    if (!(2 * area > kNoArea * longest * longest)) report.no_area.push_back(t);
    std::sort(c.begin(), c.end());
    if (!known.insert(c).second) report.repeated.push_back(t);
  }
  report.unused_points = indices_of(used_nodes(surface.triangles, surface.point_count()), false);
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

std::vector<std::pair<int, int>> find_intersections(const TriangleSurface& surface) {
  std::vector<Candidate> all;
  std::vector<int> index;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    Candidate c;
    c.corners = surface.triangles.col(t);
    for (int i = 0; i < 3; ++i) {
      c.x[i] = surface.points.col(c.corners[i]);
      c.box.extend(c.x[i]);
    }
    for (int i = 0; i < 3; ++i) c.size = std::max(c.size, (c.x[(i + 1) % 3] - c.x[i]).norm());
    c.normal = (c.x[1] - c.x[0]).cross(c.x[2] - c.x[0]);
    if (!(c.normal.norm() > kRounding * c.size * c.size)) continue;
    c.normal.normalize();
    all.push_back(c);
    index.push_back(t);
  }
  // sweep along the longest axis of the surface
  Eigen::AlignedBox3d whole;
  for (const Candidate& c : all) whole.extend(c.box);
  int axis = 0;
  if (!all.empty()) whole.sizes().maxCoeff(&axis);
  std::vector<int> order(all.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return all[a].box.min()[axis] < all[b].box.min()[axis]; });
  std::vector<std::pair<int, int>> found;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Candidate& c = all[order[i]];
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Candidate& d = all[order[j]];
      if (d.box.min()[axis] > c.box.max()[axis]) break;
      if (!c.box.intersects(d.box) || !intersect(c, d)) continue;
      found.emplace_back(std::minmax(index[order[i]], index[order[j]]));
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

SurfaceReport check(const TriangleSurface& surface) {
  SurfaceReport report;
  report.point_count = surface.point_count();
  report.triangle_count = surface.triangle_count();
  report.index_out_of_range = out_of_range(surface.triangles, surface.point_count());
  report.not_finite = not_finite(surface.points);
  if (!report.index_out_of_range.empty() || !report.not_finite.empty()) return report;
  if (surface.triangle_count() == 0) return report;
  look_at_triangles(surface, report);
  report.duplicate_points = duplicates(surface.points, kSame * diagonal(surface.points));
  const SurfaceTopology topology(surface);
  report.holes = topology.holes();
  report.non_manifold_edges = topology.crowded_edges();
  report.non_manifold_points = pinched_nodes(surface.triangles);
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
